#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/mesh.h"

namespace vultus {

/// Vertex adjacency in compressed rows. Like everything here it takes any topology, manifold or not.
struct Adjacency {
  std::vector<int> offsets;   ///< vertex_count+1
  std::vector<int> vertices;  ///< neighbours of v: [offsets[v], offsets[v+1]), sorted
  std::span<const int> of(int v) const { return {vertices.data() + offsets[v], vertices.data() + offsets[v + 1]}; }
};
Adjacency adjacency(const Topology& topology);                     ///< along polygon edges
std::vector<std::pair<int, int>> edges(const Topology& topology);  ///< polygon edges, first < second, sorted
/// True for vertices on an edge with a face of the triangulated view on one side only.
std::vector<bool> border_vertices(const Topology& topology);
/// Closed vertex loops along edges with a face on one side only, longest first, each from its lowest vertex, running
/// clockwise about the mesh's outside. Loops that touch in a vertex are kept apart by OpenMesh half-edges where the
/// mesh is manifold; where it is not, edges are chained and chains that do not close are left out.
std::vector<std::vector<int>> boundary_loops(const Topology& topology);
/// Component number of each vertex (isolated vertices have their own), numbered by first vertex.
std::vector<int> components(const Topology& topology);

/// k-d tree over points. Throws `InputError` for points that are not finite.
class PointTree {
 public:
  explicit PointTree(const Points& points);
  ~PointTree();
  PointTree(PointTree&&) noexcept;
  struct Neighbour {
    int index;
    double distance;
  };
  /// The k nearest, nearest first (ties by index).
  std::vector<Neighbour> nearest(const Eigen::Vector3d& point, int k) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vultus
