#pragma once

#include <utility>
#include <vector>

#include "core/mesh.h"

namespace vultus::scan {

/// Pairs of triangles (rows of `triangles`, the lower first; sorted) that pass through one another by more than `depth`
/// mm: both reach that far to either side of the other's plane where they meet. Triangles that share a vertex are left
/// out (they meet by right; where they fold over it is a flip), and so are surfaces that merely touch, as sealed lips
/// do. Boxes sorted, then exact predicates (CGAL; Zomorodian & Edelsbrunner 2000).
std::vector<std::pair<int, int>> self_intersections(const Triangles& triangles, const Points& positions,
                                                    double depth = 0.05);

}  // namespace vultus::scan
