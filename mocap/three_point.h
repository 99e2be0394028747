#pragma once

#include <vector>

#include "mocap/rigid_body.h"

namespace vultus::mocap {

/// Head poses from three markers alone, as published (Zhu 2006 §6.1): the motion between the local frames they span. No
/// pose where one is missing. Throws `InputError` when the three of `body` lie on a line.
std::vector<HeadPose> three_point_poses(const Take& take, const RigidBody& body);

}  // namespace vultus::mocap
