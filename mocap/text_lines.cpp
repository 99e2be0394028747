#include "mocap/text_lines.h"

#include <algorithm>
#include <cstring>

#include "core/error.h"

namespace vultus::mocap {

namespace {

constexpr std::size_t kPiece = 1 << 18;

}  // namespace

TextLines::TextLines(const std::filesystem::path& file) : path_(file) {
  std::error_code problem;
  if (!std::filesystem::exists(file, problem)) throw InputError(file, "no such file");
  if (!std::filesystem::is_regular_file(file, problem)) throw InputError(file, "is not a plain file");
  file_bytes_ = std::filesystem::file_size(file, problem);
  stream_.open(file, std::ios::binary);
  if (!stream_ || problem) throw InputError(file, "cannot be opened for reading");
}

/// Moves what is left to the buffer's start and reads more behind it; false at the end of the file.
bool TextLines::refill() {
  const std::size_t left = filled_ - start_;
  if (start_ > 0) std::memmove(buffer_.data(), buffer_.data() + start_, left);
  start_ = 0;
  filled_ = left;
  const std::size_t room = static_cast<std::size_t>(std::min<std::uint64_t>(kPiece, file_bytes_ + 1));
  if (buffer_.size() < left + room) buffer_.resize(std::max(left + room, buffer_.size() + buffer_.size() / 2));
  stream_.read(buffer_.data() + left, static_cast<std::streamsize>(buffer_.size() - left));
  filled_ += static_cast<std::size_t>(stream_.gcount());
  if (stream_.bad()) throw InputError(path_, "line " + std::to_string(number_ + 1), "cannot be read");
  return filled_ > left;
}

bool TextLines::next(std::string_view& line) {
  std::size_t searched = start_;
  const char* end = nullptr;
  while (true) {
    end = static_cast<const char*>(std::memchr(buffer_.data() + searched, '\n', filled_ - searched));
    if (end != nullptr) break;
    const std::size_t seen = filled_ - start_;
    if (!refill()) break;
    searched = seen;
  }
  if (end == nullptr && start_ == filled_) return false;
  const std::size_t stop = end == nullptr ? filled_ : static_cast<std::size_t>(end - buffer_.data());
  line = std::string_view(buffer_).substr(start_, stop - start_);
  start_ = end == nullptr ? filled_ : stop + 1;
  if (++number_ == 1 && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return true;
}

}  // namespace vultus::mocap
