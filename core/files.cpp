#include "core/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.h"

namespace vultus {
namespace {

namespace fs = std::filesystem;

class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  operator int() const { return value_; }
  int close() {
    const int result = ::close(value_);
    value_ = -1;
    return result;
  }

 private:
  int value_;
};

std::string reason() { return std::strerror(errno); }

// Beside `file`, so that the rename stays within one file system; keeps the extension, which writers go by.
fs::path temporary_beside(const fs::path& file) {
  static std::atomic<unsigned> counter{0};
  const std::string unique = std::to_string(::getpid()) + "-" + std::to_string(counter++);
  return file.parent_path() / ("." + file.stem().string() + ".partial-" + unique + file.extension().string());
}

void write_all(int descriptor, std::string_view content, const fs::path& file) {
  while (!content.empty()) {
    const ssize_t written = ::write(descriptor, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw OutputError(file, reason());
    content.remove_prefix(static_cast<std::size_t>(written));
  }
}

// A device or a pipe: renaming a file over it would destroy it.
bool is_special(const fs::path& file) {
  std::error_code error;
  return fs::exists(file, error) && !fs::is_regular_file(file, error) && !fs::is_directory(file, error);
}

int line_of_byte(std::string_view text, std::size_t byte) {
  return 1 + static_cast<int>(std::count(text.begin(), text.begin() + std::min(byte, text.size()), '\n'));
}

int edit_distance(std::string_view a, std::string_view b) {
  std::vector<int> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    int diagonal = row[0];
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int substituted = diagonal + (std::tolower(a[i - 1]) != std::tolower(b[j - 1]) ? 1 : 0);
      diagonal = row[j];
      row[j] = std::min({substituted, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string read_file(const fs::path& file, std::size_t limit) {
  Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (descriptor < 0) throw InputError(file, reason());
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) throw InputError(file, reason());
  if (S_ISDIR(status.st_mode)) throw InputError(file, "is a folder, not a file");
  if (!S_ISREG(status.st_mode)) throw InputError(file, "is not a regular file");
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size > limit) {
    throw InputError(file, std::to_string(size) + " bytes; at most " + std::to_string(limit) + " are accepted");
  }
  std::string content(size, '\0');
  std::size_t done = 0;
  while (done < size) {
    const ssize_t got = ::read(descriptor, content.data() + done, size - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw InputError(file, reason());
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  content.resize(done);
  return content;
}

void write_file(const fs::path& file, std::string_view content) {
  if (is_special(file)) {
    Descriptor descriptor(::open(file.c_str(), O_WRONLY | O_CLOEXEC));
    if (descriptor < 0) throw OutputError(file, reason());
    return write_all(descriptor, content, file);
  }
  write_file_with(file, [&](const fs::path& temporary) {
    Descriptor descriptor(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (descriptor < 0) throw OutputError(file, reason());
    write_all(descriptor, content, file);
    if (descriptor.close() != 0) throw OutputError(file, reason());
  });
}

void write_file_with(const fs::path& file, const std::function<void(const fs::path&)>& write) {
  if (file.filename().empty()) throw OutputError(file, "is not a file name");
  std::error_code error;
  if (fs::is_directory(file, error)) throw OutputError(file, "is a folder");
  if (is_special(file)) throw OutputError(file, "is not a regular file");
  if (file.has_parent_path()) make_folder(file.parent_path());
  const fs::path temporary = temporary_beside(file);
  try {
    write(temporary);
    if (!fs::exists(temporary, error)) throw OutputError(file, "nothing was written");
    fs::rename(temporary, file, error);
    if (error) throw OutputError(file, error.message());
  } catch (...) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw;
  }
}

nlohmann::json read_json(const fs::path& file) {
  constexpr std::size_t limit = std::size_t{1} << 30;
  const std::string text = read_file(file, limit);
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    throw InputError(file, "line " + std::to_string(line_of_byte(text, error.byte)), "is not valid JSON");
  }
}

void write_json(const fs::path& file, const nlohmann::json& json) {
  write_file(file, json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw OutputError(folder, error.message());
  if (!fs::is_directory(folder, error)) throw OutputError(folder, "is a file, not a folder");
}

std::string nearest_name(const std::string& word, const std::vector<std::string>& names) {
  std::string nearest;
  int best = std::numeric_limits<int>::max();
  for (const std::string& name : names) {
    const int distance = edit_distance(word, name);
    if (distance < best) {
      best = distance;
      nearest = name;
    }
  }
  return nearest;
}

}  // namespace vultus
