#include <algorithm>
#include <cstring>
#include <limits>

#include "core/error.h"
#include "core/files.h"
#include "core/mesh_files.h"

namespace vultus {
namespace mesh_files {
namespace {

namespace fs = std::filesystem;

// The largest index that a face uses, and where.
struct Use {
  int index = -1;
  std::size_t line = 0;
  bool operator<(const Use& other) const { return index < other.index; }
};

class ObjReader {
 public:
  ObjReader(const fs::path& file, std::string_view content) : file_(file), text_(content) {}

  Mesh read(NonFinite non_finite) {
    while (text_.next_line()) read_statement();
    if (positions_.empty()) throw InputError(file_, "holds no vertices");
    check_indices();
    Mesh mesh;
    mesh.positions = points_from(positions_);
    check_finite(file_, mesh.positions, non_finite);
    if (colours_.size() == positions_.size()) mesh.colours = points_from(colours_);
    mesh.texture = texture_;
    mesh.topology = make_topology(file_, topology_data());
    return mesh;
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const { throw InputError(file_, text_.place(), problem); }

  void read_statement() {
    const std::string_view keyword = text_.word();
    if (keyword == "v")
      read_vertex();
    else if (keyword == "vt")
      read_uv();
    else if (keyword == "f")
      read_face();
    else if (keyword == "mtllib" && texture_.empty())
      read_material(text_.rest_of_line());
  }

  double number(std::string_view word, const char* what) const {
    double value = 0.0;
    if (!parse(word, value)) fail("\"" + std::string(word.substr(0, 40)) + "\" is not a " + what);
    return value;
  }

  void read_vertex() {
    double values[7];
    int count = 0;
    for (std::string_view word = text_.word(); !word.empty(); word = text_.word()) {
      if (count == 7) fail("a vertex has at most 7 numbers");
      values[count++] = number(word, "coordinate");
    }
    if (count < 3) fail("a vertex needs 3 coordinates");
    positions_.insert(positions_.end(), values, values + 3);
    if (count >= 6) colours_.insert(colours_.end(), values + 3, values + 6);
  }

  void read_uv() {
    for (int k = 0; k < 2; ++k) {
      const std::string_view word = text_.word();
      if (word.empty()) fail("a UV needs 2 coordinates");
      uvs_.push_back(number(word, "UV coordinate"));
      if (!std::isfinite(uvs_.back())) fail("a UV coordinate is not finite");
    }
  }

  // Corners refer to what stands before them when negative; positive indices may point forward and are checked last.
  int index(std::string_view word, std::size_t known, const char* what) const {
    long long value = 0;
    if (!parse(word, value)) fail("\"" + std::string(word.substr(0, 40)) + "\" is not a " + what + " number");
    const long long resolved = value < 0 ? static_cast<long long>(known) + value : value - 1;
    if (value == 0 || resolved < 0 || resolved >= std::numeric_limits<int>::max()) {
      fail(std::string(what) + " " + std::to_string(value) + " does not exist");
    }
    return static_cast<int>(resolved);
  }

  void read_face() {
    const std::size_t first = faces_.corner_vertex.size();
    std::size_t with_uv = 0;
    for (std::string_view word = text_.word(); !word.empty(); word = text_.word()) {
      const auto slash = word.find('/');
      faces_.corner_vertex.push_back(index(word.substr(0, slash), positions_.size() / 3, "vertex"));
      faces_.corner_uv.push_back(-1);
      if (slash == std::string_view::npos) continue;
      const std::string_view uv = word.substr(slash + 1, word.find('/', slash + 1) - slash - 1);
      if (uv.empty()) continue;
      faces_.corner_uv.back() = index(uv, uvs_.size() / 2, "UV");
      ++with_uv;
    }
    const std::size_t corners = faces_.corner_vertex.size() - first;
    if (corners < 3) fail("a face needs 3 corners");
    if (with_uv != 0 && with_uv != corners) fail("only some corners of the face have a UV");
    faces_without_uv_ = faces_without_uv_ || with_uv == 0;
    faces_.close();
    const int line_vertex = *std::max_element(faces_.corner_vertex.begin() + first, faces_.corner_vertex.end());
    const int line_uv = *std::max_element(faces_.corner_uv.begin() + first, faces_.corner_uv.end());
    largest_vertex_ = std::max(largest_vertex_, Use{line_vertex, text_.line_number()});
    largest_uv_ = std::max(largest_uv_, Use{line_uv, text_.line_number()});
  }

  void check_indices() const {
    const auto check = [&](Use largest, std::size_t count, const char* what) {
      if (largest.index < static_cast<long long>(count)) return;
      throw InputError(file_, "line " + std::to_string(largest.line),
                       std::string(what) + " " + std::to_string(largest.index + 1LL) + " of " + std::to_string(count) +
                           " does not exist");
    };
    check(largest_vertex_, positions_.size() / 3, "vertex");
    check(largest_uv_, uvs_.size() / 2, "UV");
  }

  TopologyData topology_data() {
    TopologyData data;
    data.vertex_count = static_cast<int>(positions_.size() / 3);
    data.face_offsets = std::move(faces_.offsets);
    data.corner_vertex = std::move(faces_.corner_vertex);
    // UVs are all or nothing in a `Topology`; a file that textures only some faces counts as untextured.
    if (!uvs_.empty() && !faces_without_uv_ && !data.corner_vertex.empty()) {
      data.corner_uv = std::move(faces_.corner_uv);
      data.uvs = Eigen::Map<const Uvs>(uvs_.data(), static_cast<Eigen::Index>(uvs_.size() / 2), 2);
    }
    return data;
  }

  // A missing material file is common and harmless: the mesh is whole without it.
  void read_material(std::string_view name) {
    const fs::path material = file_.parent_path() / fs::path(std::string(name));
    std::error_code error;
    if (!fs::is_regular_file(material, error)) return;
    const std::string content = read_file(material, std::size_t{1} << 24);
    TextCursor lines(content);
    while (lines.next_line()) {
      if (lines.word() != "map_Kd") continue;
      texture_ = texture_path(material, std::string(lines.rest_of_line()));
      return;
    }
  }

  fs::path file_;
  TextCursor text_;
  std::vector<double> positions_, colours_, uvs_;
  Faces faces_;
  bool faces_without_uv_ = false;
  Use largest_vertex_, largest_uv_;
  std::string texture_;
};

class ObjText {
 public:
  void line(std::string_view keyword, const double* values, int count) {
    text_ += keyword;
    for (int k = 0; k < count; ++k) {
      text_ += ' ';
      number(values[k]);
    }
    text_ += '\n';
  }
  template <class Number>
  void number(Number value) {
    char buffer[32];
    text_.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
  }
  void text(std::string_view words) { text_ += words; }
  const std::string& content() const { return text_; }

 private:
  std::string text_;
};

}  // namespace

Mesh read_obj(const fs::path& file, std::string_view content, NonFinite non_finite) {
  return ObjReader(file, content).read(non_finite);
}

}  // namespace mesh_files

void write_obj(const std::filesystem::path& file, const Mesh& mesh) {
  const Topology& topology = *mesh.topology;
  mesh_files::ObjText text;
  for (Eigen::Index v = 0; v < mesh.positions.rows(); ++v) {
    double values[6] = {mesh.positions(v, 0), mesh.positions(v, 1), mesh.positions(v, 2)};
    if (mesh.has_colours()) std::copy_n(mesh.colours.row(v).data(), 3, values + 3);
    text.line("v", values, mesh.has_colours() ? 6 : 3);
  }
  for (Eigen::Index row = 0; row < topology.uvs().rows(); ++row) text.line("vt", topology.uvs().row(row).data(), 2);
  for (int f = 0; f < topology.face_count(); ++f) {
    const auto vertices = topology.face(f);
    const auto uv_rows = topology.face_uv(f);
    text.text("f");
    for (std::size_t c = 0; c < vertices.size(); ++c) {
      text.text(" ");
      text.number(vertices[c] + 1);
      if (uv_rows.empty()) continue;
      text.text("/");
      text.number(uv_rows[c] + 1);
    }
    text.text("\n");
  }
  write_file(file, text.content());
}

}  // namespace vultus
