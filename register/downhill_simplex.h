#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

namespace vultus::registration {

struct SimplexOptions {
  double first_size = 1.0;      ///< > 0: the start simplex is the start and one step this long along each axis
  double spread = 1e-6;         ///< ≥ 0: done when all values lie within this share of the greatest …
  double least_size = 1e-4;     ///< > 0: … or the simplex is smaller than this
  int most_evaluations = 2000;  ///< ≥ 1
  int restarts = 1;       ///< ≥ 0: times a new start simplex is set up at the minimum found, half the last one's size
  void validate() const;  ///< throws `InputError`
};

struct SimplexResult {
  Eigen::VectorXd place;
  double initial_value = 0.0, value = 0.0;
  int evaluations = 0;
  bool converged = false;  ///< false: it ran out of evaluations
};

/// Downhill simplex (Nelder & Mead 1965, reflection 1, expansion 2, contraction and shrinking ½), restarted at its
/// minimum because a simplex can collapse before it gets there (Press et al. 1992, §10.4). Never returns a place worse
/// than `start`. Deterministic.
SimplexResult downhill_simplex(const std::function<double(const Eigen::VectorXd&)>& value, const Eigen::VectorXd& start,
                               const SimplexOptions& options = {});

}  // namespace vultus::registration
