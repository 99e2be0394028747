#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>

#include "core/error.h"
#include "core/image.h"
#include "core/mesh_files.h"
#include "core/mesh_ply_header.h"

static_assert(std::endian::native == std::endian::little, "PLY reading assumes a little-endian machine");

namespace vultus::mesh_files {
namespace {

namespace fs = std::filesystem;

class AsciiBody {
 public:
  AsciiBody(const fs::path& file, const PlyHeader& header) : file_(file), rest_(header.body), line_(header.lines + 1) {}

  double read(PlyType) {
    std::size_t skipped = 0;
    while (skipped < rest_.size() && (is_blank(rest_[skipped]) || rest_[skipped] == '\n')) {
      line_ += rest_[skipped++] == '\n';
    }
    rest_.remove_prefix(skipped);
    std::size_t size = 0;
    while (size < rest_.size() && !is_blank(rest_[size]) && rest_[size] != '\n') ++size;
    if (size == 0) fail("the file ends before its last element");
    double value = 0.0;
    if (!parse(rest_.substr(0, size), value)) {
      fail("\"" + std::string(rest_.substr(0, std::min<std::size_t>(size, 40))) + "\" is not a number");
    }
    rest_.remove_prefix(size);
    return value;
  }
  std::size_t bytes_left() const { return rest_.size(); }
  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(file_, "line " + std::to_string(line_), problem);
  }

 private:
  fs::path file_;
  std::string_view rest_;
  std::size_t line_;
};

class BinaryBody {
 public:
  BinaryBody(const fs::path& file, std::string_view content, const PlyHeader& header)
      : file_(file),
        content_(content),
        position_(content.size() - header.body.size()),
        big_(header.format == PlyFormat::big) {}

  double read(PlyType type) {
    switch (type) {
      case PlyType::int8:
        return take<std::int8_t>();
      case PlyType::uint8:
        return take<std::uint8_t>();
      case PlyType::int16:
        return take<std::int16_t>();
      case PlyType::uint16:
        return take<std::uint16_t>();
      case PlyType::int32:
        return take<std::int32_t>();
      case PlyType::uint32:
        return take<std::uint32_t>();
      case PlyType::float32:
        return take<float>();
      case PlyType::float64:
        break;
    }
    return take<double>();
  }
  std::size_t bytes_left() const { return content_.size() - position_; }
  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(file_, "byte " + std::to_string(position_), problem);
  }

 private:
  template <class Value>
  Value take() {
    if (bytes_left() < sizeof(Value)) fail("the file ends before its last element");
    std::array<char, sizeof(Value)> bytes;
    std::memcpy(bytes.data(), content_.data() + position_, sizeof(Value));
    if (big_) std::reverse(bytes.begin(), bytes.end());
    position_ += sizeof(Value);
    return std::bit_cast<Value>(bytes);
  }

  fs::path file_;
  std::string_view content_;
  std::size_t position_;
  bool big_;
};

// Where each number of a vertex row goes.
enum class Slot { x, y, z, red, green, blue, u, v, none };

Slot slot_named(const std::string& name) {
  constexpr std::array<std::pair<std::string_view, Slot>, 15> slots{{{"x", Slot::x},
                                                                     {"y", Slot::y},
                                                                     {"z", Slot::z},
                                                                     {"red", Slot::red},
                                                                     {"green", Slot::green},
                                                                     {"blue", Slot::blue},
                                                                     {"diffuse_red", Slot::red},
                                                                     {"diffuse_green", Slot::green},
                                                                     {"diffuse_blue", Slot::blue},
                                                                     {"s", Slot::u},
                                                                     {"t", Slot::v},
                                                                     {"u", Slot::u},
                                                                     {"v", Slot::v},
                                                                     {"texture_u", Slot::u},
                                                                     {"texture_v", Slot::v}}};
  for (const auto& [known, slot] : slots) {
    if (known == name) return slot;
  }
  return Slot::none;
}

std::array<float, 256> linear_of_bytes() {
  std::array<float, 256> table{};
  for (int i = 0; i < 256; ++i) table[i] = linear_from_srgb(static_cast<float>(i) / 255.0f);
  return table;
}

double linear_colour(double value, PlyType type) {
  static const std::array<float, 256> table = linear_of_bytes();
  if (type == PlyType::uint8) return table[static_cast<std::size_t>(value)];
  if (type == PlyType::uint16) return linear_from_srgb(static_cast<float>(value / 65535.0));
  return value;
}

template <class Body>
class BodyReader {
 public:
  BodyReader(const fs::path& file, const PlyHeader& header, Body body)
      : file_(file), header_(header), body_(std::move(body)) {}

  Mesh read(NonFinite non_finite) {
    for (const PlyElement& element : header_.elements) {
      check_size(element);
      if (element.name == "vertex")
        read_vertices(element);
      else if (element.name == "face")
        read_faces(element);
      else
        skip(element);
    }
    if (positions_.empty()) throw InputError(file_, "holds no vertices");
    Mesh mesh;
    mesh.positions = points_from(positions_);
    check_finite(file_, mesh.positions, non_finite);
    if (colours_.size() == positions_.size()) mesh.colours = points_from(colours_);
    if (!header_.texture.empty()) mesh.texture = texture_path(file_, header_.texture);
    mesh.topology = make_topology(file_, topology_data());
    return mesh;
  }

 private:
  void check_size(const PlyElement& element) const {
    const std::size_t least = element.least_bytes(header_.format);
    // An ascii file may lack its last separator.
    if (element.count >= std::numeric_limits<int>::max() ||
        (least > 0 && element.count > (body_.bytes_left() + 1) / least)) {
      body_.fail("the file is too short for " + std::to_string(element.count) + " of \"" + element.name + "\"");
    }
  }

  std::size_t list_size(const PlyProperty& property) {
    const double count = body_.read(*property.count_type);
    const std::size_t least = header_.format == PlyFormat::ascii ? 2 : size_of(property.type);
    if (!(count >= 0.0) || count != std::floor(count) ||
        count > static_cast<double>((body_.bytes_left() + 1) / least)) {
      body_.fail("a list of " + std::to_string(count) + " numbers does not fit into the file");
    }
    return static_cast<std::size_t>(count);
  }

  void skip(const PlyProperty& property) {
    const std::size_t count = property.count_type ? list_size(property) : 1;
    for (std::size_t k = 0; k < count; ++k) body_.read(property.type);
  }

  void skip(const PlyElement& element) {
    if (element.properties.empty()) return;
    for (std::size_t row = 0; row < element.count; ++row) {
      for (const PlyProperty& property : element.properties) skip(property);
    }
  }

  void read_vertices(const PlyElement& element) {
    std::vector<Slot> slots;
    for (const PlyProperty& p : element.properties) slots.push_back(p.count_type ? Slot::none : slot_named(p.name));
    const auto has = [&](Slot slot) { return std::find(slots.begin(), slots.end(), slot) != slots.end(); };
    if (!has(Slot::x) || !has(Slot::y) || !has(Slot::z)) throw InputError(file_, "its vertices have no x, y and z");
    const bool coloured = has(Slot::red) && has(Slot::green) && has(Slot::blue);
    const bool textured = has(Slot::u) && has(Slot::v);
    positions_.reserve(3 * element.count);
    for (std::size_t row = 0; row < element.count; ++row) {
      std::array<double, 9> values{};
      for (std::size_t p = 0; p < slots.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (slots[p] == Slot::none) {
          skip(property);
          continue;
        }
        const bool colour = slots[p] >= Slot::red && slots[p] <= Slot::blue;
        const double value = body_.read(property.type);
        values[static_cast<std::size_t>(slots[p])] = colour ? linear_colour_checked(value, property.type) : value;
      }
      positions_.insert(positions_.end(), values.begin(), values.begin() + 3);
      if (coloured) colours_.insert(colours_.end(), values.begin() + 3, values.begin() + 6);
      if (textured) vertex_uvs_.insert(vertex_uvs_.end(), values.begin() + 6, values.begin() + 8);
    }
  }

  // Ascii files can write any number where the header promises a byte.
  double linear_colour_checked(double value, PlyType type) const {
    const double highest = type == PlyType::uint8    ? 255.0
                           : type == PlyType::uint16 ? 65535.0
                                                     : std::numeric_limits<double>::max();
    if (!(value >= 0.0 && value <= highest)) body_.fail("colour " + std::to_string(value) + " is out of range");
    return linear_colour(value, type);
  }

  void read_faces(const PlyElement& element) {
    const auto is_indices = [](const PlyProperty& p) {
      return p.count_type && (p.name == "vertex_indices" || p.name == "vertex_index");
    };
    if (element.count > 0 && std::none_of(element.properties.begin(), element.properties.end(), is_indices)) {
      throw InputError(file_, "its faces have no list of vertex_indices");
    }
    for (std::size_t row = 0; row < element.count; ++row) {
      std::size_t corners = 0, face_uvs = 0;
      for (const PlyProperty& property : element.properties) {
        if (is_indices(property))
          corners = read_corners(property);
        else if (property.count_type && property.name == "texcoord")
          face_uvs = read_face_uvs(property);
        else
          skip(property);
      }
      if (corners < 3) body_.fail("face " + std::to_string(row) + " has fewer than 3 corners");
      if (faces_.corner_vertex.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
        body_.fail("more corners than Vultus can hold");
      }
      every_face_has_uvs_ = every_face_has_uvs_ && face_uvs == 2 * corners;
      faces_.close();
    }
  }

  std::size_t read_corners(const PlyProperty& property) {
    const std::size_t corners = list_size(property);
    for (std::size_t k = 0; k < corners; ++k) {
      const double vertex = body_.read(property.type);
      if (!(vertex >= 0.0 && vertex < std::numeric_limits<int>::max()) || vertex != std::floor(vertex)) {
        body_.fail("vertex " + std::to_string(vertex) + " does not exist");
      }
      faces_.corner_vertex.push_back(static_cast<int>(vertex));
    }
    return corners;
  }

  std::size_t read_face_uvs(const PlyProperty& property) {
    const std::size_t count = list_size(property);
    for (std::size_t k = 0; k < count; ++k) corner_uvs_.push_back(body_.read(property.type));
    return count;
  }

  TopologyData topology_data() {
    TopologyData data;
    data.vertex_count = static_cast<int>(positions_.size() / 3);
    data.face_offsets = std::move(faces_.offsets);
    data.corner_vertex = std::move(faces_.corner_vertex);
    const std::size_t corners = data.corner_vertex.size();
    if (corners > 0 && every_face_has_uvs_ && corner_uvs_.size() == 2 * corners) {
      data.uvs = Eigen::Map<const Uvs>(corner_uvs_.data(), static_cast<Eigen::Index>(corners), 2);
      data.corner_uv.resize(corners);
      for (std::size_t c = 0; c < corners; ++c) data.corner_uv[c] = static_cast<int>(c);
    } else if (corners > 0 && 3 * vertex_uvs_.size() == 2 * positions_.size()) {
      data.uvs = Eigen::Map<const Uvs>(vertex_uvs_.data(), data.vertex_count, 2);
      data.corner_uv = data.corner_vertex;
    }
    if (!data.uvs.allFinite()) throw InputError(file_, "a UV coordinate is not finite");
    return data;
  }

  fs::path file_;
  const PlyHeader& header_;
  Body body_;
  std::vector<double> positions_, colours_, vertex_uvs_, corner_uvs_;
  Faces faces_;
  bool every_face_has_uvs_ = true;
};

}  // namespace

Mesh read_ply(const fs::path& file, std::string_view content, NonFinite non_finite) {
  const PlyHeader header = read_ply_header(file, content);
  if (header.format == PlyFormat::ascii) {
    return BodyReader<AsciiBody>(file, header, AsciiBody(file, header)).read(non_finite);
  }
  return BodyReader<BinaryBody>(file, header, BinaryBody(file, content, header)).read(non_finite);
}

}  // namespace vultus::mesh_files
