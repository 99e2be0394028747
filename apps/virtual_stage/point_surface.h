#pragma once

#include <vector>

#include "core/mesh.h"

namespace vultus::virtual_stage {

/// Triangles over a point cloud by advancing front (Cohen-Steiner and Da 2004). Every triangle's corners are rows of
/// `points`; no edge is longer than the larger `reach` (mm, one a point) of its ends, so wider gaps stay open.
/// Neighbours agree in orientation; which side of a part is its front is arbitrary. The same points give the same
/// triangles in the same order.
Triangles surface_through(const Points& points, const std::vector<double>& reach);

}  // namespace vultus::virtual_stage
