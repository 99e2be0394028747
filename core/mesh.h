#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace vultus {

using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;      ///< n×3, mm unless said otherwise
using Triangles = Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor>;      ///< m×3 vertex indices
using Uvs = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;         ///< n×2, (0,0) bottom left
using VertexSets = std::map<std::string, std::vector<int>>;                    ///< name → sorted vertex indices
using LandmarkVertices = std::map<std::string, int>;                           ///< name → vertex index

/// What a mesh is made of apart from positions; input to `Topology`.
struct TopologyData {
  int vertex_count = 0;
  std::vector<int> face_offsets;   ///< faces+1; face f has corners [face_offsets[f], face_offsets[f+1])
  std::vector<int> corner_vertex;  ///< vertex of each corner, counter-clockwise seen from outside
  std::vector<int> corner_uv;      ///< row of `uvs` for each corner; empty without UVs
  Uvs uvs;
  VertexSets sets;
  LandmarkVertices landmarks;
};

/// Connectivity, UVs and names shared by every pose: immutable. Quads and polygons are kept; `triangles()` is a
/// triangulated view (fan from each face's first corner). A pose is an n×3 `Points` beside it.
class Topology {
 public:
  /// Checks every index and that no face has fewer than 3 corners; throws `InputError` saying which face is bad.
  static std::shared_ptr<const Topology> make(TopologyData data);
  /// A triangle mesh without UVs or names.
  static std::shared_ptr<const Topology> from_triangles(int vertex_count, const Triangles& triangles);

  int vertex_count() const { return data_.vertex_count; }
  int face_count() const { return static_cast<int>(data_.face_offsets.size()) - 1; }
  std::span<const int> face(int f) const;     ///< vertices of face f
  std::span<const int> face_uv(int f) const;  ///< rows of `uvs()` for face f's corners; empty without UVs

  const Triangles& triangles() const { return triangles_; }
  const Triangles& triangle_uvs() const { return triangle_uvs_; }           ///< rows of `uvs()`; 0 rows without UVs
  const std::vector<int>& triangle_face() const { return triangle_face_; }  ///< polygon each triangle came from
  bool has_uvs() const { return data_.uvs.rows() > 0; }
  const Uvs& uvs() const { return data_.uvs; }

  const VertexSets& sets() const { return data_.sets; }
  const LandmarkVertices& landmarks() const { return data_.landmarks; }
  /// Vertices of a named set; throws `InputError` with the nearest name when there is none.
  const std::vector<int>& set(const std::string& name) const;
  bool has_set(const std::string& name) const { return data_.sets.contains(name); }

  const TopologyData& data() const { return data_; }

 private:
  explicit Topology(TopologyData data);
  TopologyData data_;
  Triangles triangles_;
  Triangles triangle_uvs_;
  std::vector<int> triangle_face_;
};

/// One shape on a topology.
struct Mesh {
  std::shared_ptr<const Topology> topology;
  Points positions;                      ///< vertex_count×3, mm
  Points colours;                        ///< vertex_count×3 linear RGB in [0, 1], or 0 rows
  std::string texture;                   ///< path of the colour image named by the file (map_Kd), or empty

  bool has_colours() const { return colours.rows() == positions.rows() && positions.rows() > 0; }
};

/// Area-weighted unit vertex normals (n×3); zero for vertices without faces.
Points vertex_normals(const Topology& topology, const Points& positions);
/// Unit normals of the triangulated view (m×3); zero for degenerate triangles.
Points triangle_normals(const Topology& topology, const Points& positions);

/// The faces whose vertices are all kept, with vertices renumbered in their old order.
struct SubMesh {
  Mesh mesh;
  std::vector<int> parent_vertex;  ///< for each vertex of `mesh`, its index in the mesh it came from
};
SubMesh sub_mesh(const Mesh& mesh, const std::vector<bool>& keep_vertex);

/// Axis-aligned bounds.
struct Box {
  Eigen::Vector3d min, max;
  Eigen::Vector3d centre() const { return 0.5 * (min + max); }
  double diagonal() const { return (max - min).norm(); }
};
Box bounds(const Points& positions);

/// A place on a mesh: a triangle of the triangulated view and barycentric coordinates that sum to one.
struct SurfacePoint {
  int triangle = -1;
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
  bool valid() const { return triangle >= 0; }
};
Eigen::Vector3d position_of(const SurfacePoint& place, const Topology& topology, const Points& positions);

}  // namespace vultus
