#pragma once

#include <utility>
#include <vector>

#include "core/mesh.h"

namespace vultus::rig {

/// Two vertices of different surfaces and the difference of their positions that a solve should reach.
struct OffsetConstraint {
  int a = -1, b = -1;
  Eigen::RowVector3d offset;  ///< a − b, mm
};

/// Deformation transfer between meshes of one topology (Sumner and Popović 2004) as a Poisson problem (Botsch et al.
/// 2006): min Σ_t Σ_edges w |(x_b − x_a) − S_t (t_b − t_a)|² + Σ_v κ_v A_v |x_v − p_v|² + Σ_c ω |x_a − x_b − o_c|²
/// with the target's cotangent weights w, the source's gradients S_t and the vertices' areas A_v.
class DeformationTransfer {
 public:
  DeformationTransfer(const Topology& topology, const Points& source_neutral, const Points& target_neutral);

  /// `rotation` turns source directions into the target's. `anchors` (n×3, mm) and their strength κ (n, 1/mm²).
  Points solve(const Points& source_pose, const Eigen::Matrix3d& rotation, const Points& anchors,
               const Eigen::VectorXd& strength, const std::vector<OffsetConstraint>& contacts) const;

 private:
  Eigen::Matrix3d gradient(Eigen::Index triangle, const Points& source_pose) const;

  Triangles triangles_;
  Points source_, target_;
  Points cotangents_;      // triangles × 3: weight of the edge opposite each corner
  Eigen::VectorXd areas_;  // vertices
};

/// Pairs of vertices that lie face to face within `distance` mm: nearest vertices of opposing normals that are no near
/// neighbours along the surface. Each pair once, a < b, sorted.
std::vector<std::pair<int, int>> contacts(const Topology& topology, const Points& positions, double distance);

}  // namespace vultus::rig
