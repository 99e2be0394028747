#pragma once

#include <vector>

#include "register/deformation_graph.h"

namespace vultus::registration {

/// A vertex drawn to a plane (row: weight · normal·(x_v − target) = 0).
struct PlaneTerm {
  int vertex;
  Eigen::Vector3d target, normal;  ///< scan frame, mm; unit
  double weight;                   ///< ≥ 0
};
/// A vertex drawn to a point.
struct PointTerm {
  int vertex;
  Eigen::Vector3d target;  ///< scan frame, mm
  double weight;           ///< ≥ 0
};

struct GraphFitWeights {
  double stiffness = 1.0;        ///< of Σ_edges |T_i(g_j) − T_j(g_j)|², mm² (Sumner et al. 2007, eq. 7)
  double scale_stiffness = 1.0;  ///< of differences in log scale between neighbours, times edge length²
  double keep_scale = 0.0;       ///< of the log scale itself, times edge length²: large for locally rigid motion
};

/// One Gauss-Newton step of a graph's pose (rotation, log scale and translation a node) under terms on its vertices,
/// solved by conjugate gradients with block-diagonal preconditioning.
class GraphFit {
 public:
  GraphFit(const DeformationGraph& graph, const Points& rest);
  /// Returns the root mean square of the nodes' movement, mm.
  double step(GraphPose& pose, const std::vector<PlaneTerm>& planes, const std::vector<PointTerm>& points,
              const GraphFitWeights& weights);
  /// Makes the shape of `pose` the one that stiffness keeps, by `share` (0: not at all, 1: wholly).
  void relax(const GraphPose& pose, double share);

 private:
  static constexpr int unknowns = 7;  // rotation, log scale, translation
  using Block = Eigen::Matrix<double, unknowns, unknowns>;
  using Part = Eigen::Matrix<double, unknowns, 1>;
  struct Column {
    int node = 0;
    Eigen::Matrix<double, 3, unknowns> jacobian = Eigen::Matrix<double, 3, unknowns>::Zero();
  };

  void vertex_columns(int vertex, const GraphPose& pose, std::vector<Column>& columns, Eigen::Vector3d& position) const;
  void add_rows(const std::vector<Column>& columns, const Eigen::Matrix3d& metric, const Eigen::Vector3d& residual);
  void add_stiffness(const GraphPose& pose, const GraphFitWeights& weights);
  Block& block(int row, int column);
  std::vector<Part> solve() const;

  const DeformationGraph& graph_;
  const Points& rest_;
  Points arms_;                         // two rows an edge: where either node expects the other, rest, mm
  std::vector<int> offsets_, columns_;  // block rows, lower and upper, sorted
  std::vector<Block> blocks_;
  std::vector<Part> right_;
};

}  // namespace vultus::registration
