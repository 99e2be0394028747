#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "retarget/weights.h"
#include "rig/actor.h"

namespace vultus::retarget {

/// The moving face: Σ_k B_k S̄ w_k (Liu et al. 2011 eq. 3). Poses and regions of the weights are found in the actor by
/// name; a take solved globally ("whole") moves every vertex alike. Keeps a reference to `actor`. Const use from many
/// threads is fine.
class Face {
 public:
  /// Throws `InputError` for a pose or region the actor lacks, with the nearest name.
  Face(const rig::Actor& actor, const std::vector<std::string>& poses, const std::vector<std::string>& regions);

  /// vertex_count×3, mm. `weights` has this face's poses and regions.
  Points at(const Weights& weights, int frame) const;
  /// The weight of each pose at each vertex, Σ_k B_k(v) w_k: vertex_count × poses.
  Eigen::MatrixXf vertex_weights(const Weights& weights, int frame) const;

 private:
  const rig::Actor& actor_;
  std::vector<int> poses_;         // index in the actor of each pose of the weights
  Eigen::MatrixXf masks_;          // vertex_count × regions
};

}  // namespace vultus::retarget
