#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/error.h"
#include "core/files.h"
#include "core/image.h"
#include "core/mesh_io.h"

static_assert(std::endian::native == std::endian::little, "PLY writing assumes a little-endian machine");

namespace vultus {
namespace {

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

void write_ply(const std::filesystem::path& file, const Mesh& mesh) {
  const Topology& topology = *mesh.topology;
  std::size_t most_corners = 0;
  for (int f = 0; f < topology.face_count(); ++f) most_corners = std::max(most_corners, topology.face(f).size());
  const bool byte_counts = most_corners < 256;
  std::string header = vertex_header(mesh.positions.rows());
  if (mesh.has_colours()) header += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  header += "element face " + std::to_string(topology.face_count()) + "\nproperty list " +
            (byte_counts ? "uchar" : "uint") + " int vertex_indices\nend_header\n";
  PlyBytes bytes(std::move(header));
  for (Eigen::Index v = 0; v < mesh.positions.rows(); ++v) {
    bytes.put_row(mesh.positions.row(v));
    if (!mesh.has_colours()) continue;
    for (int k = 0; k < 3; ++k) bytes.put(srgb_byte(mesh.colours(v, k)));
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
  std::string header = vertex_header(positions.rows());
  if (with_normals) header += "property float nx\nproperty float ny\nproperty float nz\n";
  PlyBytes bytes(header + "end_header\n");
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    bytes.put_row(positions.row(v));
    if (with_normals) bytes.put_row(normals.row(v));
  }
  write_file(file, bytes.content());
}

}  // namespace vultus
