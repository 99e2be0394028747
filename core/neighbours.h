#pragma once

#include <span>
#include <utility>
#include <vector>

#include "core/mesh.h"

namespace vultus {

/// Vertex adjacency in compressed rows, built with OpenMesh half-edges where the mesh is manifold and from the faces
/// where it is not.
struct Adjacency {
  std::vector<int> offsets;  ///< vertex_count+1
  std::vector<int> vertices; ///< neighbours of v: [offsets[v], offsets[v+1]), sorted
  std::span<const int> of(int v) const { return {vertices.data() + offsets[v], vertices.data() + offsets[v + 1]}; }
};
Adjacency adjacency(const Topology& topology);            ///< along polygon edges
std::vector<std::pair<int, int>> edges(const Topology& topology);  ///< polygon edges, first < second, sorted
std::vector<std::vector<int>> boundary_loops(const Topology& topology);  ///< closed vertex loops, longest first
/// Component number of each vertex (isolated vertices have their own), numbered by first vertex.
std::vector<int> components(const Topology& topology);

/// k-d tree over points.
class PointTree {
 public:
  explicit PointTree(const Points& points);
  ~PointTree();
  PointTree(PointTree&&) noexcept;
  struct Neighbour { int index; double distance; };
  /// The k nearest, nearest first (ties by index).
  std::vector<Neighbour> nearest(const Eigen::Vector3d& point, int k) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vultus
