#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <unordered_map>

#include "core/error.h"
#include "core/mesh_files.h"

namespace vultus::mesh_files {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t header_bytes = 84, triangle_bytes = 50, normal_bytes = 12;

// STL repeats each corner's position: equal ones become one vertex.
class Welder {
 public:
  void add(std::array<float, 3> corner) {
    for (float& value : corner) {
      if (value == 0.0f) value = 0.0f;  // -0 and +0 are one place
    }
    const auto [entry, is_new] =
        vertices_.try_emplace(std::bit_cast<Bits>(corner), static_cast<int>(positions_.size() / 3));
    if (is_new) positions_.insert(positions_.end(), corner.begin(), corner.end());
    corners_.push_back(entry->second);
  }

  Mesh mesh(const fs::path& file, NonFinite non_finite) const {
    if (corners_.empty()) throw InputError(file, "holds no triangles");
    Mesh result;
    result.positions = points_from(positions_);
    check_finite(file, result.positions, non_finite);
    const Triangles triangles =
        Eigen::Map<const Triangles>(corners_.data(), static_cast<Eigen::Index>(corners_.size() / 3), 3);
    result.topology = Topology::from_triangles(static_cast<int>(result.positions.rows()), triangles);
    return result;
  }

 private:
  using Bits = std::array<std::uint32_t, 3>;
  struct Hash {
    std::size_t operator()(const Bits& bits) const {
      std::uint64_t hash = 0xcbf29ce484222325u;
      for (const std::uint32_t word : bits) hash = (hash ^ word) * 0x9e3779b97f4a7c15u, hash ^= hash >> 29;
      return hash;
    }
  };
  std::unordered_map<Bits, int, Hash> vertices_;
  std::vector<double> positions_;
  std::vector<int> corners_;
};

std::uint32_t declared_triangles(std::string_view content) {
  std::uint32_t count = 0;
  std::memcpy(&count, content.data() + header_bytes - sizeof count, sizeof count);
  return count;
}

Mesh read_binary(const fs::path& file, std::string_view content, NonFinite non_finite) {
  const std::uint32_t count = declared_triangles(content);
  const std::size_t held = (content.size() - header_bytes) / triangle_bytes;
  if (count > held) {
    throw InputError(file, "byte " + std::to_string(header_bytes + held * triangle_bytes),
                     "the file ends after " + std::to_string(held) + " of " + std::to_string(count) + " triangles");
  }
  if (count > std::numeric_limits<int>::max() / 3)
    throw InputError(file, "byte 80", "more triangles than Vultus can hold");
  Welder welder;
  for (std::size_t t = 0; t < count; ++t) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      std::array<float, 3> position;
      const std::size_t at = header_bytes + t * triangle_bytes + normal_bytes + corner * sizeof position;
      std::memcpy(position.data(), content.data() + at, sizeof position);
      welder.add(position);
    }
  }
  return welder.mesh(file, non_finite);
}

std::array<float, 3> read_vertex(const fs::path& file, TextCursor& text) {
  std::array<float, 3> position{};
  for (float& value : position) {
    const std::string_view word = text.word();
    if (!parse(word, value)) {
      throw InputError(file, text.place(), "\"" + std::string(word.substr(0, 40)) + "\" is not a coordinate");
    }
  }
  return position;
}

Mesh read_ascii(const fs::path& file, std::string_view content, NonFinite non_finite) {
  Welder welder;
  TextCursor text(content);
  int corners = 0;
  bool ended = false;
  while (text.next_line()) {
    const std::string_view keyword = text.word();
    if (keyword == "vertex") {
      if (++corners > 3) throw InputError(file, text.place(), "a facet has 3 corners");
      welder.add(read_vertex(file, text));
    } else if (keyword == "endfacet") {
      if (corners != 3)
        throw InputError(file, text.place(), "the facet ends after " + std::to_string(corners) + " corners");
      corners = 0;
    } else if (keyword == "endsolid") {
      ended = true;
    }
  }
  if (!ended || corners != 0) throw InputError(file, text.place(), "the file ends before endsolid");
  return welder.mesh(file, non_finite);
}

}  // namespace

Mesh read_stl(const fs::path& file, std::string_view content, NonFinite non_finite) {
  // Some exporters start binary files with "solid" too, so that the size decides.
  const bool fits_binary = content.size() >= header_bytes &&
                           header_bytes + triangle_bytes * std::size_t{declared_triangles(content)} == content.size();
  if (!fits_binary && content.starts_with("solid") && content.find('\0') == std::string_view::npos) {
    return read_ascii(file, content, non_finite);
  }
  if (content.size() < header_bytes) throw InputError(file, "is too short for an STL file");
  return read_binary(file, content, non_finite);
}

}  // namespace vultus::mesh_files
