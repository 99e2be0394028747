#pragma once

#include <Eigen/StdVector>
#include <utility>
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
/// What a graph keeps of the rest shape, over its edges (i, j) and nodes.
struct GraphFitWeights {
  double smoothness = 1.0;  ///< of |T_i(g_j) − T_j(g_j)|² and |T_j(g_i) − T_i(g_i)|², mm²
  double gradient = 0.3;    ///< times smoothness, of |A_i − A_j|² times the edge's squared length
  double rigidity = 0.0;    ///< times smoothness, of |A_i − R_i|², R_i the nearest rotation, times the sum of the
                            ///< squared lengths of the node's edges: 0 lets skin stretch where that is smooth
};

/// One Gauss-Newton step of a graph's pose under terms on its vertices, each node free to move by an affine map
/// T_i(p) = A_i(p − g_i) + g_i + t_i (Amberg et al. 2007 over the graph of Sumner et al. 2007). Affine maps that change
/// slowly cost little, so that a smooth stretch, which is what one face is to another, is all but free, where locally
/// rigid or similar pieces would slide over the surface to avoid it. Solved by conjugate gradients with block-diagonal
/// preconditioning.
class GraphFit {
 public:
  GraphFit(const DeformationGraph& graph, const Points& rest);
  /// Returns the root mean square of the nodes' movement, mm.
  double step(GraphPose& pose, const std::vector<PlaneTerm>& planes, const std::vector<PointTerm>& points,
              const GraphFitWeights& weights);

 private:
  static constexpr int unknowns = 12;  // three of each column of A, then translation
  using Block = Eigen::Matrix<double, unknowns, unknowns>;
  using Part = Eigen::Matrix<double, unknowns, 1>;
  using Shape = Eigen::Vector4d;  // how a point hangs on a node: its arm and 1, times a weight
  struct Hold {
    int node;
    Shape shape;
  };

  Block& block(int row, int column);
  /// Where a vertex is, and what holds it.
  Eigen::Vector3d hang(int vertex, const GraphPose& pose, std::vector<Hold>& holds) const;
  /// Adds residualᵀ·metric·residual, linearized; `residual` is what is wanted minus what is.
  void add(const std::vector<Hold>& holds, const Eigen::Matrix3d& metric, const Eigen::Vector3d& residual);
  void add_smoothness(const GraphPose& pose, const GraphFitWeights& weights);
  void add_rigidity(const GraphPose& pose, double weight);
  std::vector<Part> solve() const;

  const DeformationGraph& graph_;
  const Points& rest_;
  std::vector<double> reach_;           // sum of the squared lengths of each node's edges, mm²
  std::vector<int> offsets_, columns_;  // block rows, lower and upper, sorted
  std::vector<Block> blocks_;
  std::vector<Part> right_;
};

}  // namespace vultus::registration
