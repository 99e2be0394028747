#pragma once

#include <vector>

#include "core/mesh.h"

namespace vultus::apps::bench {

/// Triangles of the marked vertices that face away from the same triangle of the truth (cosine below zero). `found` and
/// `truth` are n×3 in one frame.
int turned_triangles(const Topology& topology, const std::vector<bool>& marked, const Points& found,
                     const Points& truth);

}  // namespace vultus::apps::bench
