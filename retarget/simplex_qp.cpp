#include "retarget/simplex_qp.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.h"

namespace vultus::retarget {
namespace {

// A gradient this small against the problem's scale is rounding; a pivot this small means affinely dependent columns.
constexpr double kGradientTolerance = 1e-12;
constexpr double kPivotTolerance = 1e-13;
constexpr double kZeroWeight = 1e-15;

// The free variables with the Cholesky factor of (H + shift·11ᵀ) restricted to them. Σp = 0 along every direction
// taken, so the shift changes no step; it makes the factor exist for affinely independent columns of a singular H.
class FreeSet {
 public:
  FreeSet(const Eigen::MatrixXd& hessian, double shift)
      : hessian_(hessian), shift_(shift), factor_(hessian.rows(), hessian.rows()) {}

  int size() const { return static_cast<int>(indices_.size()); }
  const std::vector<int>& indices() const { return indices_; }
  bool contains(int index) const { return std::find(indices_.begin(), indices_.end(), index) != indices_.end(); }

  // False, and nothing changes, when `index` is an affine combination of the free columns.
  bool add(int index) {
    indices_.push_back(index);
    if (factor_row(size() - 1)) return true;
    indices_.pop_back();
    return false;
  }

  void remove(int position) {
    indices_.erase(indices_.begin() + position);
    for (int row = position; row < size(); ++row) factor_row(row);
  }

  Eigen::VectorXd solve(Eigen::VectorXd right) const {
    const auto lower = factor_.topLeftCorner(size(), size()).triangularView<Eigen::Lower>();
    lower.solveInPlace(right);
    lower.transpose().solveInPlace(right);
    return right;
  }

  Eigen::VectorXd shifted_column(int index) const {
    Eigen::VectorXd column(size());
    for (int i = 0; i < size(); ++i) column[i] = hessian_(indices_[i], index) + shift_;
    return column;
  }

 private:
  bool factor_row(int row) {
    const int index = indices_[row];
    for (int column = 0; column < row; ++column) {
      double sum = hessian_(index, indices_[column]) + shift_;
      for (int k = 0; k < column; ++k) sum -= factor_(row, k) * factor_(column, k);
      factor_(row, column) = sum / factor_(column, column);
    }
    const double diagonal = hessian_(index, index) + shift_;
    double pivot = diagonal;
    for (int k = 0; k < row; ++k) pivot -= factor_(row, k) * factor_(row, k);
    factor_(row, row) = std::sqrt(std::max(pivot, kPivotTolerance * diagonal));
    return pivot > kPivotTolerance * diagonal;
  }

  const Eigen::MatrixXd& hessian_;
  double shift_;
  Eigen::MatrixXd factor_;
  std::vector<int> indices_;
};

class Solver {
 public:
  Solver(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& linear, double shift, double scale)
      : hessian_(hessian),
        linear_(linear),
        tolerance_(kGradientTolerance * scale),
        free_(hessian, shift),
        weights_(Eigen::VectorXd::Zero(linear.size())),
        rejected_(linear.size(), false) {}

  void start_at_best_vertex() {
    int best = 0;
    for (int i = 1; i < linear_.size(); ++i) {
      if (0.5 * hessian_(i, i) + linear_[i] < 0.5 * hessian_(best, best) + linear_[best]) best = i;
    }
    free_.add(best);
    weights_[best] = 1.0;
  }

  void start_at(const Eigen::VectorXd& start) {
    for (int i = 0; i < start.size(); ++i) {
      if (start[i] > kZeroWeight && free_.add(i)) weights_[i] = start[i];
    }
    if (free_.size() == 0) return start_at_best_vertex();
    weights_ /= weights_.sum();
    minimise_over_free(direction());
  }

  SimplexQpResult run() {
    SimplexQpResult result;
    const int limit = 50 * static_cast<int>(linear_.size()) + 50;
    while (iterations_ < limit && step()) {
    }
    result.stopped_because = iterations_ < limit ? QpStop::optimal : QpStop::iteration_limit;
    weights_ /= weights_.sum();
    result.iterations = iterations_;
    result.weights = std::move(weights_);
    return result;
  }

 private:
  Eigen::VectorXd gradient() const {
    Eigen::VectorXd g = linear_;
    for (int i : free_.indices()) g += weights_[i] * hessian_.col(i);
    return g;
  }

  // Frees the variable with the steepest descent and minimises again; false when none descends.
  bool step() {
    const Eigen::VectorXd g = gradient();
    const double multiplier = weights_.dot(g);
    int entering = -1;
    double steepest = multiplier - tolerance_;
    for (int i = 0; i < g.size(); ++i) {
      if (g[i] < steepest && !rejected_[i] && !free_.contains(i)) {
        entering = i;
        steepest = g[i];
      }
    }
    if (entering < 0) return false;
    ++iterations_;
    if (!free_.add(entering) && !move_along_dependency(entering)) {
      rejected_[entering] = true;
      return true;
    }
    // Rounding alone can make a direction that does not let the new variable grow: then it was optimal at zero.
    Eigen::VectorXd p = direction();
    if (p[free_.size() - 1] <= 0.0 && weights_[entering] <= 0.0) {
      free_.remove(free_.size() - 1);
      rejected_[entering] = true;
      return true;
    }
    std::fill(rejected_.begin(), rejected_.end(), false);
    minimise_over_free(std::move(p));
    return true;
  }

  // The step p over the free variables to the minimum with Σp = 0.
  Eigen::VectorXd direction() const {
    const Eigen::VectorXd g = gradient();
    Eigen::VectorXd right(free_.size());
    for (int i = 0; i < free_.size(); ++i) right[i] = -g[free_.indices()[i]];
    const Eigen::VectorXd unconstrained = free_.solve(right);
    const Eigen::VectorXd ones = free_.solve(Eigen::VectorXd::Ones(free_.size()));
    return unconstrained - (unconstrained.sum() / ones.sum()) * ones;
  }

  // `entering` is an affine combination of the free columns: the objective is linear along it, so go to the bound.
  bool move_along_dependency(int entering) {
    const Eigen::VectorXd p = -free_.solve(free_.shifted_column(entering));
    const int blocking = walk(p, entering, 1e300);
    if (blocking < 0) return false;
    drop_zeros(blocking);
    return free_.add(entering);
  }

  // Repeats full steps, the first along p, each cut at the first bound, until a full step fits.
  void minimise_over_free(Eigen::VectorXd p) {
    for (;; p = direction()) {
      const int blocking = walk(p, -1, 1.0);
      drop_zeros(blocking);
      if (blocking < 0) return;
      ++iterations_;
    }
  }

  // Moves along p over the free variables (and +1 for `entering`) up to `longest`; the position that hit its bound,
  // or -1.
  int walk(const Eigen::VectorXd& p, int entering, double longest) {
    int blocking = -1;
    double length = longest;
    for (int i = 0; i < p.size(); ++i) {
      if (p[i] >= 0.0) continue;
      const double to_bound = -weights_[free_.indices()[i]] / p[i];
      if (to_bound < length) {
        length = to_bound;
        blocking = i;
      }
    }
    if (length >= 1e300) return -1;
    for (int i = 0; i < p.size(); ++i) weights_[free_.indices()[i]] += length * p[i];
    if (entering >= 0) weights_[entering] = length;
    if (blocking >= 0) weights_[free_.indices()[blocking]] = 0.0;
    return blocking;
  }

  void drop_zeros(int blocking) {
    for (int i = free_.size() - 1; i >= 0; --i) {
      const int index = free_.indices()[i];
      if (i != blocking && weights_[index] > kZeroWeight) continue;
      weights_[index] = 0.0;
      free_.remove(i);
    }
  }

  const Eigen::MatrixXd& hessian_;
  const Eigen::VectorXd& linear_;
  double tolerance_;
  FreeSet free_;
  Eigen::VectorXd weights_;
  std::vector<bool> rejected_;
  int iterations_ = 0;
};

double scale_of(double diagonal, const Eigen::VectorXd& linear) {
  const double scale = diagonal + linear.cwiseAbs().maxCoeff();
  return scale > 0.0 ? scale : 1.0;
}

}  // namespace

SimplexQp::SimplexQp(Eigen::MatrixXd hessian) : hessian_(std::move(hessian)) {
  if (hessian_.rows() == 0 || hessian_.rows() != hessian_.cols()) {
    throw InputError("quadratic programme: the matrix must be square and not empty");
  }
  if (!hessian_.allFinite()) throw InputError("quadratic programme: the matrix has values that are not finite");
  diagonal_ = hessian_.diagonal().maxCoeff();
  const double mean = hessian_.diagonal().mean();
  shift_ = mean > 0.0 ? mean : 1.0;
}

SimplexQpResult SimplexQp::solve(const Eigen::VectorXd& linear) const { return solve(linear, {}); }

SimplexQpResult SimplexQp::solve(const Eigen::VectorXd& linear, const Eigen::VectorXd& start) const {
  if (linear.size() != size() || !linear.allFinite()) {
    throw InputError("quadratic programme: the linear term must have one finite value a pose");
  }
  Solver solver(hessian_, linear, shift_, scale_of(diagonal_, linear));
  if (start.size() == size()) {
    solver.start_at(start);
  } else {
    solver.start_at_best_vertex();
  }
  SimplexQpResult result = solver.run();
  result.kkt_residual = kkt_residual(hessian_, linear, result.weights);
  return result;
}

double kkt_residual(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& linear, const Eigen::VectorXd& weights) {
  const Eigen::VectorXd gradient = hessian * weights + linear;
  const double multiplier = weights.dot(gradient) / weights.sum();
  const double scale = scale_of(hessian.diagonal().maxCoeff(), linear);
  double residual = std::abs(weights.sum() - 1.0);
  for (int i = 0; i < weights.size(); ++i) {
    residual = std::max(residual, -weights[i]);
    residual = std::max(residual, (multiplier - gradient[i]) / scale);
    if (weights[i] > 0.0) residual = std::max(residual, (gradient[i] - multiplier) / scale);
  }
  return residual;
}

}  // namespace vultus::retarget
