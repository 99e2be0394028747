#pragma once

#include <Eigen/Core>

namespace vultus::retarget {

enum class QpStop { optimal, iteration_limit };

struct SimplexQpResult {
  Eigen::VectorXd weights;     ///< n, ≥ 0, sums to one
  double kkt_residual = 0.0;   ///< largest violation of feasibility, stationarity and complementarity (see `SimplexQp`)
  int iterations = 0;          ///< changes of the active set
  QpStop stopped_because = QpStop::optimal;
};

/// min ½ wᵀHw + fᵀw subject to w ≥ 0, Σw = 1 (Liu eq. 2; w ≤ 1 follows), solved to rounding by a primal active-set
/// method (Nocedal & Wright 2006 §16.5, with Wolfe's 1976 rule that the free columns stay affinely independent).
/// H is n×n, symmetric positive semidefinite; it may be singular (duplicate poses, fewer marker rows than poses): then
/// one of the solutions comes back, always the same one for the same H, f and start.
/// The residual is relative: gradients are divided by max(diag H) + max|f|.
/// Queries are const and may run from many threads.
class SimplexQp {
 public:
  /// Throws `InputError` for a matrix that is empty, not square or not finite.
  explicit SimplexQp(Eigen::MatrixXd hessian);

  /// Starts from the best single pose, so the answer depends on H and f alone.
  SimplexQpResult solve(const Eigen::VectorXd& linear) const;
  /// Starts from the support of `start` (n, ≥ 0), such as the frame before.
  SimplexQpResult solve(const Eigen::VectorXd& linear, const Eigen::VectorXd& start) const;

  const Eigen::MatrixXd& hessian() const { return hessian_; }
  int size() const { return static_cast<int>(hessian_.rows()); }

 private:
  Eigen::MatrixXd hessian_;
  double shift_ = 1.0;     ///< H + shift·11ᵀ is definite wherever H is on Σw = const
  double diagonal_ = 0.0;  ///< max(diag H)
};

/// The residual `SimplexQp` reports, for any candidate w.
double kkt_residual(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& linear, const Eigen::VectorXd& weights);

}  // namespace vultus::retarget
