#pragma once

#include <vector>

#include "core/mesh.h"

namespace vultus::registration {

/// True for triangles of the triangulated view that look against the mean of their corners' normals.
std::vector<bool> turned_triangles(const Topology& topology, const Points& positions);
/// True for those turned in `positions` but not in `reference`: folded over by the deformation.
std::vector<bool> folded_triangles(const Topology& topology, const Points& reference, const Points& positions);

/// Smooths folds out and leaves all else where it is. Around each fold vertices become the mean of their neighbours,
/// weighted by the mean value coordinates of `reference` (Floater 2003; positive, so that nothing folds within a ring
/// that does not, and exact for a plane however it is stretched), plus as much of the reference's curvature as does not
/// fold again. The piece grows each round until no fold is left in it or `rounds` are over; one that cannot be
/// smoothed stays as it is, and so does the mesh's border. `reference` may be in another frame.
Points unfolded(const Topology& topology, const Points& reference, const Points& positions, int rounds = 12);

}  // namespace vultus::registration
