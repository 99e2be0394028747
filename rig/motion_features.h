#pragma once

#include <span>
#include <vector>

#include "core/mesh.h"
#include "core/neighbours.h"
#include "register/template.h"

namespace vultus::rig {

/// For each vertex the one nearest to its mirror image across x = 0 in `rest`, among `candidates` (true: may be used);
/// its own index where it is no candidate.
std::vector<int> mirror_vertices(const Points& rest, const std::vector<bool>& candidates);

/// −1 (right) … 1 (left) on the upper face, from the eyes' level up, 0 on the lower; all 0 without the landmarks of
/// eyes and nose. Brows and lids of both sides act alone even where every pose of a scan session is symmetric; jaw,
/// nose and lips are one.
Eigen::VectorXd upper_face_side(const Points& neutral, const registration::Ibug68& points);

struct MotionFeatureWeights {
  double place = 0.3;  ///< of the place on the head, in units of the used vertices' spread; keeps patches compact
  double side = 0.7;   ///< of `upper_face_side`
};

/// What the default segmentation clusters: for each used vertex the pattern of its displacements over all poses
/// (3(poses − 1) numbers, of length one), its place on the head and its `side`. Vertices that every pose moves alike
/// are near each other, so that one weight vector serves them all. Reduced to the principal components that hold 99 %
/// of the variance; rows of unused vertices are zero. With `mirror`, each row also holds its mirror image's motion, so
/// that both sides are seen alike.
Eigen::MatrixXd motion_features(std::span<const Points* const> poses, const std::vector<bool>& used,
                                const std::vector<int>& mirror, const Eigen::VectorXd& side,
                                const MotionFeatureWeights& weights = {});

}  // namespace vultus::rig
