#pragma once

#include <span>
#include <vector>

#include "core/mesh.h"
#include "core/neighbours.h"

namespace vultus::rig {

/// For each vertex the one nearest to its mirror image across x = 0 in `rest`, among `candidates` (true: may be used);
/// its own index where it is no candidate.
std::vector<int> mirror_vertices(const Points& rest, const std::vector<bool>& candidates);

/// What the default segmentation clusters: for each used vertex the pattern of its displacements over all poses
/// (3(poses − 1) numbers, of length one), and `place_weight` times its place on the head, in units of the used vertices'
/// spread. Vertices that every pose moves alike are near each other, so that one weight vector serves them all. Reduced
/// to the principal components that hold 99 % of the variance; rows of unused vertices are zero.
/// With `mirror`, each row also holds its mirror image's motion, so that both sides are seen alike.
Eigen::MatrixXd motion_features(std::span<const Points* const> poses, const std::vector<bool>& used,
                                const std::vector<int>& mirror, double place_weight = 0.3);

}  // namespace vultus::rig
