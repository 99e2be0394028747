#pragma once

#include <vector>

#include "core/mesh.h"

namespace vultus::registration {

/// True for triangles of the triangulated view that look against the mean of their corners' normals in `positions` but
/// not in `reference`: folded over by the deformation.
std::vector<bool> folded_triangles(const Topology& topology, const Points& reference, const Points& positions);

/// Smooths folds out: vertices of folded triangles and their neighbours take the displacement from `reference` (same
/// frame) that their surroundings give them, a wider ring each round until no fold is left or `rounds` are over.
Points unfolded(const Topology& topology, const Points& reference, const Points& positions, int rounds = 4);

}  // namespace vultus::registration
