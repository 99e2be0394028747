#include "core/transform.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.h"
#include "core/statistics.h"

namespace vultus {
namespace {

Eigen::VectorXd checked_weights(const Points& source, const Points& target, const Eigen::VectorXd& weights) {
  if (source.rows() != target.rows()) {
    throw InputError("alignment: " + std::to_string(source.rows()) + " source points but " +
                     std::to_string(target.rows()) + " target points");
  }
  if (weights.size() == 0) return Eigen::VectorXd::Ones(source.rows());
  if (weights.size() != source.rows()) throw InputError("alignment: one weight for each point is needed");
  if (!weights.allFinite() || weights.minCoeff() < 0.0) throw InputError("alignment: weights must be finite and ≥ 0");
  return weights;
}

void check_spread(const Points& centred, const Eigen::VectorXd& weights, const char* which) {
  const Eigen::Matrix3d scatter = centred.transpose() * weights.asDiagonal() * centred;
  const Eigen::Vector3d spread = Eigen::JacobiSVD<Eigen::Matrix3d>(scatter).singularValues();
  constexpr double collinear = 1e-12;  // ratio of squared extents: 1e-6 of the length
  if (!scatter.allFinite() || !(spread(1) > collinear * spread(0))) {
    throw InputError(std::string("alignment: the ") + which + " points are collinear or not finite");
  }
}

Eigen::VectorXd residuals_of(const Similarity& target_from_source, const Points& source, const Points& target) {
  return (transformed(target_from_source, source) - target).rowwise().norm();
}

}  // namespace

Similarity Similarity::operator*(const Similarity& first) const {
  return {scale * first.scale, rotation * first.rotation, *this * first.translation};
}

Similarity Similarity::inverse() const {
  Similarity result;
  result.scale = 1.0 / scale;
  result.rotation = rotation.transpose();
  result.translation = -result.scale * (result.rotation * translation);
  return result;
}

Points transformed(const Similarity& target_from_source, const Points& points) {
  Points moved = target_from_source.scale * (points * target_from_source.rotation.transpose());
  moved.rowwise() += target_from_source.translation.transpose();
  return moved;
}

Similarity fit_similarity(const Points& source, const Points& target, Scaling scaling, const Eigen::VectorXd& weights) {
  const Eigen::VectorXd w = checked_weights(source, target, weights);
  if ((w.array() > 0.0).count() < 3) throw InputError("alignment: at least 3 points are needed");
  const double total = w.sum();
  const Eigen::RowVector3d source_mean = (w.transpose() * source) / total;
  const Eigen::RowVector3d target_mean = (w.transpose() * target) / total;
  const Points s = source.rowwise() - source_mean;
  const Points t = target.rowwise() - target_mean;
  check_spread(s, w, "source");
  check_spread(t, w, "target");

  const Eigen::Matrix3d covariance = t.transpose() * w.asDiagonal() * s;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d handedness = Eigen::Vector3d::Ones();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0) handedness(2) = -1.0;

  Similarity result;
  result.rotation = svd.matrixU() * handedness.asDiagonal() * svd.matrixV().transpose();
  if (scaling == Scaling::free) {
    result.scale = svd.singularValues().dot(handedness) / w.dot(s.rowwise().squaredNorm());
  }
  result.translation = target_mean.transpose() - result.scale * (result.rotation * source_mean.transpose());
  return result;
}

RobustFit fit_similarity_robust(const Points& source, const Points& target, Scaling scaling, double noise_floor) {
  constexpr int max_iterations = 50;
  constexpr double biweight_tuning = 4.685;      // 95 % efficiency on Gaussian noise
  constexpr double deviation_from_mad = 1.4826;  // of a Gaussian
  RobustFit fit;
  fit.weights = Eigen::VectorXd::Ones(source.rows());
  fit.target_from_source = fit_similarity(source, target, scaling);
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    fit.residuals = residuals_of(fit.target_from_source, source, target);
    const double spread = std::max(deviation_from_mad * quantile(fit.residuals, 0.5), noise_floor);
    const Eigen::ArrayXd u = fit.residuals.array() / (biweight_tuning * spread);
    const Eigen::VectorXd weights = (u < 1.0).select((1.0 - u.square()).square(), 0.0);
    if ((weights.array() > 0.0).count() < 3) break;
    const double change = (weights - fit.weights).cwiseAbs().maxCoeff();
    fit.weights = weights;
    fit.target_from_source = fit_similarity(source, target, scaling, weights);
    if (change < 1e-9) break;
  }
  fit.residuals = residuals_of(fit.target_from_source, source, target);
  fit.rms = std::sqrt(fit.weights.dot(fit.residuals.cwiseAbs2()) / fit.weights.sum());
  return fit;
}

}  // namespace vultus
