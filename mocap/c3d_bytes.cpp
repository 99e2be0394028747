#include "mocap/c3d_bytes.h"

#include "core/error.h"

namespace vultus::mocap {

FileBytes::FileBytes(const std::filesystem::path& file) : path_(file) {
  std::error_code problem;
  if (!std::filesystem::exists(file, problem)) throw InputError(file, "no such file");
  if (!std::filesystem::is_regular_file(file, problem)) throw InputError(file, "is not a plain file");
  size_ = std::filesystem::file_size(file, problem);
  stream_.open(file, std::ios::binary);
  if (!stream_ || problem) throw InputError(file, "cannot be opened for reading");
}

void FileBytes::read(std::uint64_t offset, std::span<std::uint8_t> target, const std::string& what) {
  if (offset > size_ || target.size() > size_ - offset) {
    throw InputError(path_, "byte " + std::to_string(offset),
                     "the file ends at byte " + std::to_string(size_) + ", but " + what + " needs " +
                         std::to_string(target.size()) + " bytes here");
  }
  stream_.clear();
  stream_.seekg(static_cast<std::streamoff>(offset));
  stream_.read(reinterpret_cast<char*>(target.data()), static_cast<std::streamsize>(target.size()));
  if (!stream_) throw InputError(path_, "byte " + std::to_string(offset), "cannot be read (" + what + ")");
}

}  // namespace vultus::mocap
