#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/mesh.h"
#include "retarget/marker_map.h"
#include "rig/actor.h"
#include "rig/markers.h"

namespace vultus::retarget {

/// The marker positions of every pose of the rig: S of Liu et al. 2011 §3.1. The first pose is the neutral.
struct MarkerBasis {
  std::vector<std::string> labels;  ///< markers that take part
  std::vector<std::string> poses;   ///< the rig's, in its order
  Eigen::MatrixXd columns;          ///< 3·markers × poses: x, y, z of each marker, mm; 0 for poses that are not usable
  std::vector<bool> usable;         ///< one a pose; the weight of a pose that was not captured stays zero
  std::vector<std::string> notes;   ///< markers left out, samples filled, poses missing

  int markers() const { return static_cast<int>(labels.size()); }
  Eigen::Vector3d at(int marker, int pose) const { return columns.block<3, 1>(3 * marker, pose); }
};

/// S from a training session (Liu §3.1): `captured` has one labels×3 array a pose, in the mocap actor's space, with NaN
/// rows for missing markers and no rows for a pose that was not captured. A marker missing in the neutral is left out;
/// one missing in another pose is filled by the motion of the markers around it (RBF map neutral → pose); a pose with
/// fewer than half of the markers counts as not captured. All of it stands in `notes`. Throws `InputError` when the
/// neutral is missing.
MarkerBasis basis_from_training(const std::vector<std::string>& labels, const std::vector<std::string>& poses,
                                const std::vector<Points>& captured);

/// S from the rig's own surface: the places carried along by the rig's poses, in rig space. Takes come there by
/// `to_rig` (Sánchez §5.1) or `to_rig_by_scale` (Zhu §6.2).
MarkerBasis basis_from_surface(const rig::Actor& actor, const std::vector<std::string>& labels,
                               const std::vector<SurfacePoint>& places);

}  // namespace vultus::retarget
