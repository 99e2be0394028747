#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// What a PLY file says about itself before its numbers; not part of the library's interface.
namespace vultus::mesh_files {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
enum class PlyFormat { ascii, little, big };

inline std::size_t size_of(PlyType type) {
  constexpr std::array<std::size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

struct PlyProperty {
  std::string name;
  PlyType type;
  std::optional<PlyType> count_type;  // set for lists
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;
  // No row is smaller than this: a binary list may be empty, an ascii number is a digit and a separator.
  std::size_t least_bytes(PlyFormat format) const {
    std::size_t bytes = 0;
    for (const PlyProperty& p : properties)
      bytes += format == PlyFormat::ascii ? 2 : size_of(p.count_type.value_or(p.type));
    return bytes;
  }
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::string texture;
  std::size_t lines = 0;
  std::string_view body;
};

/// Throws `InputError` naming the line of a header that is malformed or has no end.
PlyHeader read_ply_header(const std::filesystem::path& file, std::string_view content);

}  // namespace vultus::mesh_files
