#include "core/mesh.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "core/error.h"
#include "core/files.h"

namespace vultus {
namespace {

std::string face_label(int face) { return "face " + std::to_string(face); }

void check_faces(const TopologyData& data) {
  const auto& offsets = data.face_offsets;
  if (offsets.front() != 0 || offsets.back() != static_cast<int>(data.corner_vertex.size())) {
    throw InputError("topology: face offsets do not cover the corners");
  }
  const bool with_uvs = !data.corner_uv.empty();
  if (with_uvs && data.corner_uv.size() != data.corner_vertex.size()) {
    throw InputError("topology: some corners have a UV and some have none");
  }
  for (std::size_t f = 0; f + 1 < offsets.size(); ++f) {
    const int face = static_cast<int>(f);
    if (offsets[f] < 0 || offsets[f + 1] > offsets.back() || offsets[f + 1] - offsets[f] < 3) {
      throw InputError("topology: " + face_label(face) + " has fewer than 3 corners");
    }
    for (int c = offsets[f]; c < offsets[f + 1]; ++c) {
      if (data.corner_vertex[c] < 0 || data.corner_vertex[c] >= data.vertex_count) {
        throw InputError("topology: " + face_label(face) + " uses vertex " + std::to_string(data.corner_vertex[c]) +
                         " of " + std::to_string(data.vertex_count));
      }
      if (with_uvs && (data.corner_uv[c] < 0 || data.corner_uv[c] >= data.uvs.rows())) {
        throw InputError("topology: " + face_label(face) + " uses UV " + std::to_string(data.corner_uv[c]) + " of " +
                         std::to_string(data.uvs.rows()));
      }
    }
  }
}

void check_names(TopologyData& data) {
  const auto outside = [&](int v) { return v < 0 || v >= data.vertex_count; };
  for (auto& [name, vertices] : data.sets) {
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    if (std::any_of(vertices.begin(), vertices.end(), outside)) {
      throw InputError("topology: vertex set \"" + name + "\" names a vertex outside the mesh");
    }
  }
  for (const auto& [name, vertex] : data.landmarks) {
    if (outside(vertex)) throw InputError("topology: landmark \"" + name + "\" is at a vertex outside the mesh");
  }
}

}  // namespace

std::shared_ptr<const Topology> Topology::make(TopologyData data) {
  if (data.vertex_count < 0) throw InputError("topology: negative vertex count");
  if (data.face_offsets.empty()) data.face_offsets.push_back(0);
  check_faces(data);
  check_names(data);
  return std::shared_ptr<const Topology>(new Topology(std::move(data)));
}

std::shared_ptr<const Topology> Topology::from_triangles(int vertex_count, const Triangles& triangles) {
  TopologyData data;
  data.vertex_count = vertex_count;
  data.corner_vertex.assign(triangles.data(), triangles.data() + triangles.size());
  data.face_offsets.resize(triangles.rows() + 1);
  for (std::size_t f = 0; f < data.face_offsets.size(); ++f) data.face_offsets[f] = static_cast<int>(3 * f);
  return make(std::move(data));
}

Topology::Topology(TopologyData data) : data_(std::move(data)) {
  const auto triangle_count = data_.corner_vertex.size() - 2 * static_cast<std::size_t>(face_count());
  triangles_.resize(static_cast<Eigen::Index>(triangle_count), 3);
  triangle_uvs_.resize(data_.corner_uv.empty() ? 0 : static_cast<Eigen::Index>(triangle_count), 3);
  triangle_face_.reserve(triangle_count);
  for (int f = 0; f < face_count(); ++f) {
    const auto vertices = face(f);
    const auto uv_rows = face_uv(f);
    for (std::size_t c = 1; c + 1 < vertices.size(); ++c) {
      const auto t = static_cast<Eigen::Index>(triangle_face_.size());
      triangles_.row(t) << vertices[0], vertices[c], vertices[c + 1];
      if (!uv_rows.empty()) triangle_uvs_.row(t) << uv_rows[0], uv_rows[c], uv_rows[c + 1];
      triangle_face_.push_back(f);
    }
  }
}

std::span<const int> Topology::face(int f) const {
  const auto begin = data_.face_offsets[f], end = data_.face_offsets[f + 1];
  return {data_.corner_vertex.data() + begin, static_cast<std::size_t>(end - begin)};
}

std::span<const int> Topology::face_uv(int f) const {
  if (data_.corner_uv.empty()) return {};
  const auto begin = data_.face_offsets[f], end = data_.face_offsets[f + 1];
  return {data_.corner_uv.data() + begin, static_cast<std::size_t>(end - begin)};
}

const std::vector<int>& Topology::set(const std::string& name) const {
  const auto found = data_.sets.find(name);
  if (found != data_.sets.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [known, vertices] : data_.sets) names.push_back(known);
  const std::string near = nearest_name(name, names);
  throw InputError("no vertex set \"" + name + "\"" + (near.empty() ? "" : "; did you mean \"" + near + "\"?"));
}

Points vertex_normals(const Topology& topology, const Points& positions) {
  Points normals = Points::Zero(positions.rows(), 3);
  const Triangles& triangles = topology.triangles();
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::RowVector3d a = positions.row(triangles(t, 0)), b = positions.row(triangles(t, 1)),
                             c = positions.row(triangles(t, 2));
    const Eigen::RowVector3d doubled_area = (b - a).cross(c - a);
    for (int k = 0; k < 3; ++k) normals.row(triangles(t, k)) += doubled_area;
  }
  for (auto normal : normals.rowwise()) normal.normalize();  // unlike the column-wise form, leaves zero rows alone
  return normals;
}

Points triangle_normals(const Topology& topology, const Points& positions) {
  const Triangles& triangles = topology.triangles();
  Points normals(triangles.rows(), 3);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::RowVector3d a = positions.row(triangles(t, 0)), b = positions.row(triangles(t, 1)),
                             c = positions.row(triangles(t, 2));
    normals.row(t) = (b - a).cross(c - a).normalized();
  }
  return normals;
}

SubMesh sub_mesh(const Mesh& mesh, const std::vector<bool>& keep_vertex) {
  const Topology& topology = *mesh.topology;
  if (keep_vertex.size() != static_cast<std::size_t>(topology.vertex_count())) {
    throw InputError("sub-mesh: one flag for each vertex is needed");
  }
  SubMesh result;
  std::vector<int> new_vertex(keep_vertex.size(), -1);
  for (std::size_t v = 0; v < keep_vertex.size(); ++v) {
    if (!keep_vertex[v]) continue;
    new_vertex[v] = static_cast<int>(result.parent_vertex.size());
    result.parent_vertex.push_back(static_cast<int>(v));
  }
  TopologyData data;
  data.vertex_count = static_cast<int>(result.parent_vertex.size());
  data.uvs = topology.uvs();
  data.face_offsets.push_back(0);
  for (int f = 0; f < topology.face_count(); ++f) {
    const auto vertices = topology.face(f);
    if (!std::all_of(vertices.begin(), vertices.end(), [&](int v) { return keep_vertex[v]; })) continue;
    for (int v : vertices) data.corner_vertex.push_back(new_vertex[v]);
    for (int uv : topology.face_uv(f)) data.corner_uv.push_back(uv);
    data.face_offsets.push_back(static_cast<int>(data.corner_vertex.size()));
  }
  for (const auto& [name, vertices] : topology.sets()) {
    auto& kept = data.sets[name];
    for (int v : vertices) {
      if (keep_vertex[v]) kept.push_back(new_vertex[v]);
    }
  }
  for (const auto& [name, vertex] : topology.landmarks()) {
    if (keep_vertex[vertex]) data.landmarks[name] = new_vertex[vertex];
  }
  result.mesh.topology = Topology::make(std::move(data));
  result.mesh.positions = mesh.positions(result.parent_vertex, Eigen::all);
  if (mesh.has_colours()) result.mesh.colours = mesh.colours(result.parent_vertex, Eigen::all);
  result.mesh.texture = mesh.texture;
  return result;
}

Box bounds(const Points& positions) {
  if (positions.rows() == 0) throw InputError("bounds of no points");
  return {positions.colwise().minCoeff().transpose(), positions.colwise().maxCoeff().transpose()};
}

Eigen::Vector3d position_of(const SurfacePoint& place, const Topology& topology, const Points& positions) {
  const auto triangle = topology.triangles().row(place.triangle);
  return place.barycentric(0) * positions.row(triangle(0)).transpose() +
         place.barycentric(1) * positions.row(triangle(1)).transpose() +
         place.barycentric(2) * positions.row(triangle(2)).transpose();
}

}  // namespace vultus
