#pragma once

#include "core/random.h"
#include "core/transform.h"

namespace vultus::virtual_stage {

/// Rigid head pose: up to `max_rotation` radians about each axis (y, then x, then z), up to `max_shift` mm along each.
Similarity random_pose(Random random, double max_rotation, double max_shift);

}  // namespace vultus::virtual_stage
