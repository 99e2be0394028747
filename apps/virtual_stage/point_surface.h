#pragma once

#include "core/mesh.h"

namespace vultus::virtual_stage {

/// Triangles over a point cloud by advancing front (Cohen-Steiner and Da 2004). Every triangle's corners are rows of
/// `points`; no edge is longer than `max_edge` mm, so wider gaps stay open. Neighbours agree in
/// orientation; which side of a part is its front is arbitrary.
Triangles surface_through(const Points& points, double max_edge);

}  // namespace vultus::virtual_stage
