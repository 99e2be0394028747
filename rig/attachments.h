#pragma once

#include <span>
#include <vector>

#include "core/mesh.h"

namespace vultus::rig {

/// The vertices of the largest connected part of a topology, its skin. True for skin.
std::vector<bool> skin_vertices(const Topology& topology);

/// What is not joined to the skin (teeth, tongue, eyeballs, lashes) has no region of its own and follows the skin: for
/// each such vertex the skin vertex whose region weights it takes; -1 for skin.
/// - A part that every pose moves rigidly follows, as a whole, the one skin vertex that moves most like its middle; a
///   part that never moves follows the nearest.
/// - A part that deforms follows, vertex by vertex, the skin vertex that moves most like it among the nearest few.
std::vector<int> attachments(const Topology& topology, std::span<const Points* const> poses,
                             const std::vector<bool>& skin);

}  // namespace vultus::rig
