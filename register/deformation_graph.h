#pragma once

#include <Eigen/Core>
#include <Eigen/StdVector>
#include <utility>
#include <vector>

#include "core/mesh.h"

namespace vultus::registration {

/// Nodes spread over a surface, each of which moves its surroundings as one locally rigid (or similar) piece; distances
/// run along edges of the surface, so that the lips do not hold each other (Sumner et al. 2007; Li et al. 2008).
struct DeformationGraph {
  struct Influence {
    int node;
    double weight;  ///< of one vertex, sums to 1
  };
  std::vector<int> node_vertex;            ///< vertex each node sits on
  Points nodes;                            ///< node_count×3, rest, mm
  std::vector<int> offsets;                ///< vertex_count+1: influences of v are [offsets[v], offsets[v+1])
  std::vector<Influence> influences;       ///< none for inactive vertices
  std::vector<std::pair<int, int>> edges;  ///< nodes that share vertices, first < second, sorted
  int size() const { return static_cast<int>(node_vertex.size()); }
};

/// Nodes about `spacing[v]` mm (> 0) apart along the surface around vertex v, over the vertices that are `active`.
/// Every active vertex hangs on up to four nodes of its own connected piece.
DeformationGraph make_graph(const Topology& topology, const Points& rest, const std::vector<bool>& active,
                            const Eigen::VectorXd& spacing);

/// A pose of the graph: node j takes a rest point p near it to linear[j]·(p − node_j) + node_j + translation_j.
struct GraphPose {
  std::vector<Eigen::Matrix3d> linear;
  Points translation;  ///< node_count×3, mm
  static GraphPose rest(const DeformationGraph& graph);
};

/// Rest vertices moved by the graph; vertices without influence stay at their row of `otherwise`.
Points deformed(const DeformationGraph& graph, const GraphPose& pose, const Points& rest, const Points& otherwise);

/// The graph pose nearest to given positions: each node takes the similarity (or rigid motion) of its vertices.
GraphPose pose_like(const DeformationGraph& graph, const Points& rest, const Points& positions, bool free_scale);

}  // namespace vultus::registration
