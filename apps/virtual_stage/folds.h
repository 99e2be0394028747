#pragma once

#include <utility>
#include <vector>

#include "apps/virtual_stage/face_features.h"

namespace vultus::virtual_stage {

/// A line along which skin folds, worked out on a finer mesh than the muscles: how much each vertex sinks (or, beside
/// the line, rises) along its normal when the fold is at its fullest, and the muscles that fold it.
struct Fold {
  std::vector<int> vertices;
  Eigen::VectorXd depth;                         ///< for each of `vertices`, mm, negative inward
  std::vector<std::pair<Muscle, double>> drive;  ///< share of each muscle's strength; the sum counts up to 1
  double always = 0.0;                           ///< part that is there at rest
  Side side = Side::left;

  double strength(const Activations& activations) const;
};

/// Forehead lines, frown lines, lines across the nose's root and along its sides, crow's feet, bags and lines under the
/// eyes, nasolabial and marionette folds, smile brackets, the chin's crease and the lips' purse strings, both sides.
/// `face` has the names; `fine` (n×3, mm) are the rest positions of the mesh that folds, with its normals' mesh being
/// the same skin; only vertices with `skin` > 0 fold.
std::vector<Fold> folds(const FaceFeatures& face, const Points& fine, const Eigen::VectorXd& skin);

}  // namespace vultus::virtual_stage
