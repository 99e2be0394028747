#pragma once

#include "core/mesh.h"

namespace vultus {

enum class RbfKernel {
  multiquadric,          ///< sqrt(d² + r²), Hardy 1971; Zhu eq. 4.2
  inverse_multiquadric,  ///< 1 / sqrt(d² + r²); Sánchez eq. 15
};

/// Scattered-data map of space f(x) = A·[x, 1] + Σ w_i φ_i(|x − x_i|) through given point pairs, with a radius for each
/// centre: its distance to the nearest other centre (Zhu eq. 4.3, Sánchez eq. 16).
class RbfMap {
 public:
  struct Options {
    RbfKernel kernel = RbfKernel::multiquadric;
    bool affine = true;            ///< false: the bare sum of Zhu eq. 4.1
    double smoothing = 0.0;        ///< added to the diagonal, ≥ 0; 0 interpolates exactly
  };

  /// Fits f(source row i) = target row i. Coincident centres are an `InputError` naming the rows; so are fewer than
  /// 4 pairs (or coplanar ones) with the affine term.
  RbfMap(const Points& source, const Points& target, const Options& options);
  RbfMap(const Points& source, const Points& target) : RbfMap(source, target, Options{}) {}

  Eigen::Vector3d operator()(const Eigen::Vector3d& point) const;
  Points operator()(const Points& points) const;
  double max_residual() const { return max_residual_; }  ///< at the centres, mm

 private:
  Options options_;
  Points centres_;
  Eigen::VectorXd radii_;
  Points weights_;                           // m×3
  Eigen::Matrix<double, 4, 3> affine_;       // rows: x, y, z, 1
  double max_residual_ = 0.0;
};

}  // namespace vultus
