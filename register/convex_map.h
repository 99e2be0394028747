#pragma once

#include <array>
#include <vector>

#include "core/mesh.h"

namespace vultus::registration::layout {

/// A disc of triangles to flatten.
struct Disc {
  Points positions;                           ///< n×3, mm
  std::vector<std::array<int, 3>> triangles;  ///< counter-clockwise seen from outside
  std::vector<std::vector<int>> holes;        ///< inner boundary loops, closed by a virtual vertex each
  std::vector<int> outline;                   ///< outer boundary loop
  Uvs outline_uv;                             ///< its convex counter-clockwise place, one row a vertex
  std::vector<double> importance;             ///< of each triangle: wished texture scale relative to the others
};

/// Flattens a disc by convex combinations (Tutte 1963; Floater 1997, 2003): one-to-one for any positive weights.
/// `rounds` times the weight of each neighbour is divided by the root of its stretch (Yoshizawa et al. 2004, damped).
Uvs convex_map(const Disc& disc, int rounds);

}  // namespace vultus::registration::layout
