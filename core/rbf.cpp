#include "core/rbf.h"

#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <limits>
#include <string>

#include "core/error.h"

namespace vultus {
namespace {

double kernel_value(RbfKernel kernel, double squared_distance, double radius) {
  const double value = std::sqrt(squared_distance + radius * radius);
  return kernel == RbfKernel::multiquadric ? value : 1.0 / value;
}

/// Distance of each centre to the nearest other one (Zhu eq. 4.3, Sánchez eq. 16).
Eigen::VectorXd nearest_distances(const Points& centres) {
  const double extent = bounds(centres).diagonal();
  Eigen::VectorXd radii(centres.rows());
  for (Eigen::Index i = 0; i < centres.rows(); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (Eigen::Index j = 0; j < centres.rows(); ++j) {
      if (j == i) continue;
      const double distance = (centres.row(i) - centres.row(j)).norm();
      if (distance <= 1e-9 * extent)
        throw InputError("radial basis functions: rows " + std::to_string(std::min(i, j)) + " and " +
                         std::to_string(std::max(i, j)) + " have the same source position; remove one of them");
      nearest = std::min(nearest, distance);
    }
    radii[i] = nearest;
  }
  return radii;
}

void check_pairs(const Points& source, const Points& target, const RbfMap::Options& options) {
  if (source.rows() != target.rows())
    throw InputError("radial basis functions: " + std::to_string(source.rows()) + " source and " +
                     std::to_string(target.rows()) + " target positions; they must pair up");
  if (!(options.smoothing >= 0.0)) throw InputError("radial basis functions: smoothing must be 0 or more");
  const int needed = options.affine ? 4 : 2;
  if (source.rows() < needed)
    throw InputError("radial basis functions: " + std::to_string(source.rows()) + " pairs given, at least " +
                     std::to_string(needed) + " needed");
  for (Eigen::Index i = 0; i < source.rows(); ++i)
    if (!source.row(i).allFinite() || !target.row(i).allFinite())
      throw InputError("radial basis functions: row " + std::to_string(i) + " is not finite");
  if (!options.affine) return;
  const Points centred = source.rowwise() - source.colwise().mean();
  const Eigen::Vector3d spread = Eigen::JacobiSVD<Eigen::MatrixXd>(centred).singularValues();
  if (spread[2] <= 1e-9 * spread[0])
    throw InputError("radial basis functions: the source positions lie in one plane; the affine term needs one off it");
}

/// Partial pivoting as published; full pivoting where its answer does not satisfy the system.
Eigen::MatrixXd solve(const Eigen::MatrixXd& system, const Eigen::MatrixXd& right) {
  Eigen::MatrixXd solution = system.partialPivLu().solve(right);
  const double tolerance = 1e-9 * right.cwiseAbs().maxCoeff();
  if (!solution.allFinite() || (system * solution - right).cwiseAbs().maxCoeff() > tolerance)
    solution = system.fullPivLu().solve(right);
  return solution;
}

}  // namespace

RbfMap::RbfMap(const Points& source, const Points& target, const Options& options)
    : options_(options), centres_(source) {
  check_pairs(source, target, options);
  radii_ = nearest_distances(source);
  affine_.setZero();

  // The affine columns are taken about the centroid in units of the extent, so that they are as large as the kernel's.
  const Eigen::Index m = source.rows(), k = options.affine ? 4 : 0;
  const Eigen::RowVector3d centroid = source.colwise().mean();
  const double extent = bounds(source).diagonal();
  const double column_scale = options.kernel == RbfKernel::multiquadric ? extent : 1.0 / extent;
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(m + k, m + k), right = Eigen::MatrixXd::Zero(m + k, 3);
  for (Eigen::Index j = 0; j < m; ++j) {
    for (Eigen::Index i = 0; i < m; ++i)
      system(j, i) = kernel_value(options.kernel, (source.row(j) - source.row(i)).squaredNorm(), radii_[i]);
    system(j, j) += options.smoothing;
    if (k > 0) {
      system.block<1, 3>(j, m) = (source.row(j) - centroid) * (column_scale / extent);
      system(j, m + 3) = column_scale;
    }
  }
  if (k > 0) system.bottomLeftCorner(k, m) = system.topRightCorner(m, k).transpose();
  right.topRows(m) = target;

  const Eigen::MatrixXd solution = solve(system, right);
  weights_ = solution.topRows(m);
  if (k > 0) {
    affine_.topRows<3>() = solution.middleRows(m, 3) * (column_scale / extent);
    affine_.row(3) = solution.row(m + 3) * column_scale - centroid * affine_.topRows<3>();
  }
  max_residual_ = ((*this)(source)-target).rowwise().norm().maxCoeff();
}

Eigen::Vector3d RbfMap::operator()(const Eigen::Vector3d& point) const {
  Eigen::Vector3d value = affine_.topRows<3>().transpose() * point + affine_.row(3).transpose();
  for (Eigen::Index i = 0; i < centres_.rows(); ++i) {
    const double squared = (centres_.row(i).transpose() - point).squaredNorm();
    value += kernel_value(options_.kernel, squared, radii_[i]) * weights_.row(i).transpose();
  }
  return value;
}

Points RbfMap::operator()(const Points& points) const {
  Points mapped(points.rows(), 3);
  tbb::parallel_for(Eigen::Index{0}, points.rows(),
                    [&](Eigen::Index i) { mapped.row(i) = (*this)(Eigen::Vector3d(points.row(i))).transpose(); });
  return mapped;
}

}  // namespace vultus
