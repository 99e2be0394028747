#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>

#include "core/error.h"
#include "core/files.h"
#include "core/image.h"
#include "core/mesh_files.h"

static_assert(std::endian::native == std::endian::little, "PLY reading and writing assume a little-endian machine");

namespace vultus {
namespace mesh_files {
namespace {

namespace fs = std::filesystem;

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
enum class Format { ascii, little, big };

std::size_t size_of(Type type) {
  constexpr std::array<std::size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

std::optional<Type> type_named(std::string_view name) {
  constexpr std::array<std::string_view, 16> names{"char",  "uchar",  "short",   "ushort", "int",   "uint",
                                                   "float", "double", "int8",    "uint8",  "int16", "uint16",
                                                   "int32", "uint32", "float32", "float64"};
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<Type>((found - names.begin()) % 8);
}

struct Property {
  std::string name;
  Type type;
  std::optional<Type> count_type;  // set for lists
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
  // No row is smaller than this: a binary list may be empty, an ascii number is a digit and a separator.
  std::size_t least_bytes(Format format) const {
    std::size_t bytes = 0;
    for (const Property& p : properties) bytes += format == Format::ascii ? 2 : size_of(p.count_type.value_or(p.type));
    return bytes;
  }
};

struct Header {
  Format format = Format::ascii;
  std::vector<Element> elements;
  std::string texture;
  std::size_t lines = 0;
  std::string_view body;
};

class HeaderReader {
 public:
  HeaderReader(const fs::path& file, std::string_view content) : file_(file), text_(content) {}

  Header read() {
    text_.next_line();
    if (text_.word() != "ply") fail("a PLY file starts with \"ply\"");
    bool has_format = false;
    for (;;) {
      if (!text_.next_line()) fail("the header has no end_header");
      ++header_.lines;
      const std::string_view keyword = text_.word();
      if (keyword == "end_header") break;
      if (keyword == "format")
        has_format = read_format();
      else if (keyword == "element")
        read_element();
      else if (keyword == "property")
        read_property();
      else if (keyword == "comment" && text_.word() == "TextureFile")
        header_.texture = text_.rest_of_line();
    }
    if (!has_format) fail("the header names no format");
    ++header_.lines;
    header_.body = text_.rest_of_file();
    return header_;
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const { throw InputError(file_, text_.place(), problem); }

  bool read_format() {
    const std::string_view name = text_.word();
    if (name == "ascii")
      header_.format = Format::ascii;
    else if (name == "binary_little_endian")
      header_.format = Format::little;
    else if (name == "binary_big_endian")
      header_.format = Format::big;
    else
      fail("format \"" + std::string(name.substr(0, 40)) + "\" is not ascii or binary_{little,big}_endian");
    return true;
  }

  void read_element() {
    Element element;
    element.name = text_.word();
    if (element.name.empty() || !parse(text_.word(), element.count)) fail("an element needs a name and a count");
    header_.elements.push_back(std::move(element));
  }

  Type read_type() {
    const std::string_view name = text_.word();
    const auto type = type_named(name);
    if (!type) fail("\"" + std::string(name.substr(0, 40)) + "\" is not a PLY type");
    return *type;
  }

  void read_property() {
    if (header_.elements.empty()) fail("a property stands before the first element");
    Property property;
    const TextCursor before = text_;
    if (text_.word() == "list") {
      property.count_type = read_type();
      if (*property.count_type >= Type::float32) fail("a list's count cannot be a float");
    } else {
      text_ = before;
    }
    property.type = read_type();
    property.name = text_.word();
    if (property.name.empty()) fail("a property needs a name");
    header_.elements.back().properties.push_back(std::move(property));
  }

  fs::path file_;
  TextCursor text_;
  Header header_;
};

class AsciiBody {
 public:
  AsciiBody(const fs::path& file, const Header& header) : file_(file), rest_(header.body), line_(header.lines + 1) {}

  double read(Type) {
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
  BinaryBody(const fs::path& file, std::string_view content, const Header& header)
      : file_(file),
        content_(content),
        position_(content.size() - header.body.size()),
        big_(header.format == Format::big) {}

  double read(Type type) {
    switch (type) {
      case Type::int8:
        return take<std::int8_t>();
      case Type::uint8:
        return take<std::uint8_t>();
      case Type::int16:
        return take<std::int16_t>();
      case Type::uint16:
        return take<std::uint16_t>();
      case Type::int32:
        return take<std::int32_t>();
      case Type::uint32:
        return take<std::uint32_t>();
      case Type::float32:
        return take<float>();
      case Type::float64:
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

double linear_colour(double value, Type type) {
  static const std::array<float, 256> table = linear_of_bytes();
  if (type == Type::uint8) return table[static_cast<std::size_t>(value)];
  if (type == Type::uint16) return linear_from_srgb(static_cast<float>(value / 65535.0));
  return value;
}

template <class Body>
class BodyReader {
 public:
  BodyReader(const fs::path& file, const Header& header, Body body)
      : file_(file), header_(header), body_(std::move(body)) {}

  Mesh read(NonFinite non_finite) {
    for (const Element& element : header_.elements) {
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
    mesh.texture = header_.texture;
    mesh.topology = make_topology(file_, topology_data());
    return mesh;
  }

 private:
  void check_size(const Element& element) const {
    const std::size_t least = element.least_bytes(header_.format);
    // An ascii file may lack its last separator.
    if (element.count >= std::numeric_limits<int>::max() ||
        (least > 0 && element.count > (body_.bytes_left() + 1) / least)) {
      body_.fail("the file is too short for " + std::to_string(element.count) + " of \"" + element.name + "\"");
    }
  }

  std::size_t list_size(const Property& property) {
    const double count = body_.read(*property.count_type);
    const std::size_t least = header_.format == Format::ascii ? 2 : size_of(property.type);
    if (!(count >= 0.0) || count != std::floor(count) ||
        count > static_cast<double>((body_.bytes_left() + 1) / least)) {
      body_.fail("a list of " + std::to_string(count) + " numbers does not fit into the file");
    }
    return static_cast<std::size_t>(count);
  }

  void skip(const Property& property) {
    const std::size_t count = property.count_type ? list_size(property) : 1;
    for (std::size_t k = 0; k < count; ++k) body_.read(property.type);
  }

  void skip(const Element& element) {
    if (element.properties.empty()) return;
    for (std::size_t row = 0; row < element.count; ++row) {
      for (const Property& property : element.properties) skip(property);
    }
  }

  void read_vertices(const Element& element) {
    std::vector<Slot> slots;
    for (const Property& p : element.properties) slots.push_back(p.count_type ? Slot::none : slot_named(p.name));
    const auto has = [&](Slot slot) { return std::find(slots.begin(), slots.end(), slot) != slots.end(); };
    if (!has(Slot::x) || !has(Slot::y) || !has(Slot::z)) throw InputError(file_, "its vertices have no x, y and z");
    const bool coloured = has(Slot::red) && has(Slot::green) && has(Slot::blue);
    const bool textured = has(Slot::u) && has(Slot::v);
    positions_.reserve(3 * element.count);
    for (std::size_t row = 0; row < element.count; ++row) {
      std::array<double, 9> values{};
      for (std::size_t p = 0; p < slots.size(); ++p) {
        const Property& property = element.properties[p];
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
  double linear_colour_checked(double value, Type type) const {
    const double highest = type == Type::uint8    ? 255.0
                           : type == Type::uint16 ? 65535.0
                                                  : std::numeric_limits<double>::max();
    if (!(value >= 0.0 && value <= highest)) body_.fail("colour " + std::to_string(value) + " is out of range");
    return linear_colour(value, type);
  }

  void read_faces(const Element& element) {
    const auto is_indices = [](const Property& p) {
      return p.count_type && (p.name == "vertex_indices" || p.name == "vertex_index");
    };
    if (element.count > 0 && std::none_of(element.properties.begin(), element.properties.end(), is_indices)) {
      throw InputError(file_, "its faces have no list of vertex_indices");
    }
    for (std::size_t row = 0; row < element.count; ++row) {
      std::size_t corners = 0, face_uvs = 0;
      for (const Property& property : element.properties) {
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

  std::size_t read_corners(const Property& property) {
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

  std::size_t read_face_uvs(const Property& property) {
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
  const Header& header_;
  Body body_;
  std::vector<double> positions_, colours_, vertex_uvs_, corner_uvs_;
  Faces faces_;
  bool every_face_has_uvs_ = true;
};

class PlyBytes {
 public:
  explicit PlyBytes(std::string header) : bytes_(std::move(header)) {}
  template <class Value>
  void put(Value value) {
    const auto raw = std::bit_cast<std::array<char, sizeof(Value)>>(value);
    bytes_.append(raw.data(), raw.size());
  }
  void put_row(const Eigen::Ref<const Eigen::RowVector3d>& row) {
    for (int k = 0; k < 3; ++k) put(static_cast<float>(row(k)));
  }
  const std::string& content() const { return bytes_; }

 private:
  std::string bytes_;
};

std::string vertex_header(Eigen::Index count) {
  return "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(count) +
         "\nproperty float x\nproperty float y\nproperty float z\n";
}

std::uint8_t srgb_byte(double linear) {
  const float encoded = srgb_from_linear(std::clamp(static_cast<float>(linear), 0.0f, 1.0f));
  return static_cast<std::uint8_t>(std::lround(255.0f * encoded));
}

}  // namespace

Mesh read_ply(const fs::path& file, std::string_view content, NonFinite non_finite) {
  const Header header = HeaderReader(file, content).read();
  if (header.format == Format::ascii) {
    return BodyReader<AsciiBody>(file, header, AsciiBody(file, header)).read(non_finite);
  }
  return BodyReader<BinaryBody>(file, header, BinaryBody(file, content, header)).read(non_finite);
}

}  // namespace mesh_files

void write_ply(const std::filesystem::path& file, const Mesh& mesh) {
  const Topology& topology = *mesh.topology;
  std::size_t most_corners = 0;
  for (int f = 0; f < topology.face_count(); ++f) most_corners = std::max(most_corners, topology.face(f).size());
  const bool byte_counts = most_corners < 256;
  std::string header = mesh_files::vertex_header(mesh.positions.rows());
  if (mesh.has_colours()) header += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  header += "element face " + std::to_string(topology.face_count()) + "\nproperty list " +
            (byte_counts ? "uchar" : "uint") + " int vertex_indices\nend_header\n";
  mesh_files::PlyBytes bytes(std::move(header));
  for (Eigen::Index v = 0; v < mesh.positions.rows(); ++v) {
    bytes.put_row(mesh.positions.row(v));
    if (!mesh.has_colours()) continue;
    for (int k = 0; k < 3; ++k) bytes.put(mesh_files::srgb_byte(mesh.colours(v, k)));
  }
  for (int f = 0; f < topology.face_count(); ++f) {
    const auto vertices = topology.face(f);
    if (byte_counts)
      bytes.put(static_cast<std::uint8_t>(vertices.size()));
    else
      bytes.put(static_cast<std::uint32_t>(vertices.size()));
    for (int v : vertices) bytes.put(static_cast<std::int32_t>(v));
  }
  write_file(file, bytes.content());
}

void write_ply_points(const std::filesystem::path& file, const Points& positions, const Points& normals) {
  const bool with_normals = normals.rows() > 0;
  if (with_normals && normals.rows() != positions.rows()) throw InputError(file, "one normal for each point is needed");
  std::string header = mesh_files::vertex_header(positions.rows());
  if (with_normals) header += "property float nx\nproperty float ny\nproperty float nz\n";
  mesh_files::PlyBytes bytes(header + "end_header\n");
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    bytes.put_row(positions.row(v));
    if (with_normals) bytes.put_row(normals.row(v));
  }
  write_file(file, bytes.content());
}

}  // namespace vultus
