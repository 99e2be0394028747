#pragma once

#include <Eigen/Core>

#include "core/mesh.h"

namespace vultus {

/// Similarity `y = scale * rotation * x + translation`; with `scale == 1` a rigid motion.
/// Objects are named `target_from_source`.
struct Similarity {
  double scale = 1.0;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // mm

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return scale * (rotation * point) + translation; }
  Similarity operator*(const Similarity& first) const;  ///< `(a * b) * x == a * (b * x)`
  Similarity inverse() const;
};

/// Every row of `points` (n×3) moved by `target_from_source`.
Points transformed(const Similarity& target_from_source, const Points& points);

enum class Scaling { fixed, free };

/// Least-squares similarity (or rigid motion) with `target ≈ T * source`; rows correspond (Umeyama 1991).
/// `weights` is empty (all one) or one non-negative value a row. Needs 3 rows of positive weight that are not
/// collinear; throws `InputError` otherwise.
Similarity fit_similarity(const Points& source, const Points& target, Scaling scaling,
                          const Eigen::VectorXd& weights = {});

struct RobustFit {
  Similarity target_from_source;
  Eigen::VectorXd weights;      ///< n, in [0, 1]; 0 for rows taken as outliers
  Eigen::VectorXd residuals;    ///< n, mm
  double rms = 0.0;             ///< weighted, mm
};

/// `fit_similarity` iteratively re-weighted with Tukey's biweight; the spread is the median absolute residual,
/// never below `noise_floor` mm.
RobustFit fit_similarity_robust(const Points& source, const Points& target, Scaling scaling, double noise_floor = 0.05);

}  // namespace vultus
