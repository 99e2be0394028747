#pragma once

#include <vector>

#include "core/mesh.h"

namespace vultus::registration {

/// True for triangles of the triangulated view that make an angle of more than 90 degrees with a neighbour in
/// `positions` but less than 60 in `reference`: skin crumpled by the fit, such as nostrils, rims of lids and lips that
/// nothing held in place. Edges with other than two triangles are left out.
std::vector<bool> crumpled_triangles(const Topology& topology, const Points& reference, const Points& positions);

}  // namespace vultus::registration
