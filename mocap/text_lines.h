#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace vultus::mocap {

/// A text file line by line, through a buffer that grows to the longest line and no further.
class TextLines {
 public:
  /// Throws `InputError` when the file is missing, not a plain file or not readable.
  explicit TextLines(const std::filesystem::path& file);

  /// The next line without its end (LF or CR LF; a byte-order mark is passed over); false at the end of the file. The
  /// line is good until the next call. Throws `InputError` when reading fails.
  bool next(std::string_view& line);
  std::size_t number() const { return number_; }  ///< of the line that `next` gave last, from 1
  std::uint64_t file_bytes() const { return file_bytes_; }

 private:
  bool refill();

  std::filesystem::path path_;
  std::ifstream stream_;
  std::uint64_t file_bytes_ = 0;
  std::string buffer_;
  std::size_t start_ = 0, filled_ = 0, number_ = 0;
};

}  // namespace vultus::mocap
