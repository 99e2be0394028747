#pragma once

#include <vector>

#include "core/mesh.h"

namespace vultus::registration {

/// Undoes small folds by moving single vertices: those of triangles that look against their corners' normals in
/// `positions` but not in `reference`, and the vertices around them, go towards the mean of their neighbours as far as
/// that turns such triangles back (after Freitag & Plassmann 2000). Nothing else moves, `held` vertices neither. Folds
/// that it cannot undo are left.
Points untangled(const Topology& topology, const Points& reference, const Points& positions,
                 const std::vector<bool>& held);

}  // namespace vultus::registration
