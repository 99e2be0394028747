#include "register/downhill_simplex.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.h"

namespace vultus::registration {
namespace {

struct Corner {
  Eigen::VectorXd place;
  double value;
};

/// One simplex from its start to its end, best corner first.
class Simplex {
 public:
  Simplex(const std::function<double(const Eigen::VectorXd&)>& value, const Corner& start, double size,
          const SimplexOptions& options, int& evaluations)
      : value_(value), options_(options), evaluations_(evaluations), corners_{start} {
    for (Eigen::Index axis = 0; axis < start.place.size(); ++axis) {
      Eigen::VectorXd place = start.place;
      place[axis] += size;
      corners_.push_back(at(place));
    }
    sort();
  }

  /// Returns whether it came to rest within the evaluations allowed.
  bool run() {
    while (!at_rest()) {
      if (evaluations_ >= options_.most_evaluations) return false;
      step();
      sort();
    }
    return true;
  }
  const Corner& best() const { return corners_.front(); }

 private:
  Corner at(const Eigen::VectorXd& place) {
    ++evaluations_;
    return {place, value_(place)};
  }
  void sort() {
    std::stable_sort(corners_.begin(), corners_.end(),
                     [](const Corner& a, const Corner& b) { return a.value < b.value; });
  }
  bool at_rest() const {
    const double best = corners_.front().value, worst = corners_.back().value;
    double size = 0.0;
    for (const Corner& corner : corners_)
      size = std::max(size, (corner.place - corners_.front().place).lpNorm<Eigen::Infinity>());
    return size < options_.least_size || worst - best <= options_.spread * (std::abs(worst) + std::abs(best));
  }

  void step() {
    Corner& worst = corners_.back();
    const double second = corners_[corners_.size() - 2].value;
    Eigen::VectorXd centre = Eigen::VectorXd::Zero(worst.place.size());
    for (std::size_t i = 0; i + 1 < corners_.size(); ++i) centre += corners_[i].place;
    centre /= static_cast<double>(corners_.size() - 1);
    const Eigen::VectorXd arm = centre - worst.place;
    const Corner reflected = at(centre + arm);
    if (reflected.value < best().value) {
      const Corner expanded = at(centre + 2.0 * arm);
      worst = expanded.value < reflected.value ? expanded : reflected;
    } else if (reflected.value < second) {
      worst = reflected;
    } else {
      const bool outside = reflected.value < worst.value;
      const Corner contracted = at(centre + (outside ? 0.5 : -0.5) * arm);
      if (contracted.value < std::min(reflected.value, worst.value))
        worst = contracted;
      else
        for (std::size_t i = 1; i < corners_.size(); ++i)
          corners_[i] = at(corners_[0].place + 0.5 * (corners_[i].place - corners_[0].place));
    }
  }

  const std::function<double(const Eigen::VectorXd&)>& value_;
  const SimplexOptions& options_;
  int& evaluations_;
  std::vector<Corner> corners_;
};

}  // namespace

void SimplexOptions::validate() const {
  if (!(first_size > 0.0 && least_size > 0.0 && spread >= 0.0))
    throw InputError("downhill simplex: sizes must be positive and the spread must not be negative");
  if (most_evaluations < 1 || restarts < 0)
    throw InputError("downhill simplex: at least one evaluation and no negative number of restarts");
}

SimplexResult downhill_simplex(const std::function<double(const Eigen::VectorXd&)>& value, const Eigen::VectorXd& start,
                               const SimplexOptions& options) {
  options.validate();
  SimplexResult result;
  result.evaluations = 1;
  Corner best{start, value(start)};
  result.initial_value = best.value;
  double size = options.first_size;
  for (int run = 0; run <= options.restarts; ++run, size *= 0.5) {
    Simplex simplex(value, best, size, options, result.evaluations);
    result.converged = simplex.run();
    best = simplex.best();
    if (!result.converged) break;
  }
  result.place = best.place;
  result.value = best.value;
  return result;
}

}  // namespace vultus::registration
