#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>

namespace vultus::mocap {

/// Number formats of a C3D file, by the byte in its parameter section.
enum class Processor : std::uint8_t { intel = 84, dec = 85, mips = 86 };

/// Decodes numbers as the processor that wrote the file stored them.
struct Decoder {
  Processor processor = Processor::intel;

  std::uint16_t word(const std::uint8_t* b) const {
    return processor == Processor::mips ? static_cast<std::uint16_t>(b[0] << 8 | b[1])
                                        : static_cast<std::uint16_t>(b[1] << 8 | b[0]);
  }
  std::int16_t integer(const std::uint8_t* b) const { return static_cast<std::int16_t>(word(b)); }
  float real(const std::uint8_t* b) const {
    const std::uint32_t high = word(processor == Processor::intel ? b + 2 : b);
    const std::uint32_t low = word(processor == Processor::intel ? b : b + 2);
    const float value = std::bit_cast<float>(high << 16 | low);
    return processor == Processor::dec ? value / 4.0F : value;  // VAX F-floating: exponent bias 128, hidden bit 0.1…
  }
};

/// A file read piece by piece, every piece checked against its size first.
class FileBytes {
 public:
  /// Throws `InputError` when the file is missing, not a plain file or not readable.
  explicit FileBytes(const std::filesystem::path& file);

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size() const { return size_; }
  /// Fills `target` from `offset`; throws `InputError` naming the byte when the file ends before.
  void read(std::uint64_t offset, std::span<std::uint8_t> target, const std::string& what);

 private:
  std::filesystem::path path_;
  std::ifstream stream_;
  std::uint64_t size_ = 0;
};

}  // namespace vultus::mocap
