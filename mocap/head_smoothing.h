#pragma once

#include <vector>

#include "mocap/rigid_body.h"

namespace vultus::mocap {

/// Takes the markers' noise out of the head's path: in every frame a polynomial in time (of second degree,
/// up to sixth over long stretches) is fitted to the poses around it
/// (local regression, Cleveland 1979), each weighted by its markers. How many frames take part is decided anew
/// everywhere: as many as predict the pose that was left out best over the second on both sides (cross-validation,
/// Stone 1974), and none where that predicts worse than the noise of a single pose, so that fast motion stays. Poses
/// that it would move by four times their noise stay too. Poses of kind `none` stay so.
std::vector<HeadPose> smoothed_poses(const std::vector<HeadPose>& poses, const RigidBody& body, double rate_hz);

}  // namespace vultus::mocap
