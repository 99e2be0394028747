#include "mocap/assignment.h"

#include <limits>

#include "core/error.h"

namespace vultus::mocap {

namespace {

/// One row more is given a column along the shortest augmenting path. `row_of` and the potentials count from 1; 0 is
/// the row that is being placed.
struct Matching {
  const Eigen::MatrixXd& cost;
  std::vector<double> row_potential, column_potential;
  std::vector<int> row_of;

  explicit Matching(const Eigen::MatrixXd& c)
      : cost(c),
        row_potential(static_cast<std::size_t>(c.rows()) + 1, 0.0),
        column_potential(static_cast<std::size_t>(c.cols()) + 1, 0.0),
        row_of(static_cast<std::size_t>(c.cols()) + 1, 0) {}

  void place(int row) {
    const std::size_t columns = row_of.size();
    std::vector<double> least(columns, std::numeric_limits<double>::infinity());
    std::vector<std::size_t> before(columns, 0);
    std::vector<bool> used(columns, false);
    row_of[0] = row;
    std::size_t at = 0;
    do {
      used[at] = true;
      const int i = row_of[at];
      double step = std::numeric_limits<double>::infinity();
      std::size_t next = 0;
      for (std::size_t j = 1; j < columns; ++j) {
        if (used[j]) continue;
        const double reduced = cost(i - 1, static_cast<Eigen::Index>(j) - 1) -
                               row_potential[static_cast<std::size_t>(i)] - column_potential[j];
        if (reduced < least[j]) {
          least[j] = reduced;
          before[j] = at;
        }
        if (least[j] < step) {
          step = least[j];
          next = j;
        }
      }
      for (std::size_t j = 0; j < columns; ++j) {
        if (used[j]) {
          row_potential[static_cast<std::size_t>(row_of[j])] += step;
          column_potential[j] -= step;
        } else {
          least[j] -= step;
        }
      }
      at = next;
    } while (row_of[at] != 0);
    for (; at != 0; at = before[at]) row_of[at] = row_of[before[at]];
  }
};

}  // namespace

std::vector<int> least_cost_assignment(const Eigen::MatrixXd& cost) {
  if (cost.rows() > cost.cols()) throw UsageError("an assignment needs as many columns as rows");
  if (!cost.allFinite()) throw UsageError("the costs of an assignment must be finite");
  Matching matching(cost);
  for (int row = 1; row <= cost.rows(); ++row) matching.place(row);
  std::vector<int> column_of(static_cast<std::size_t>(cost.rows()), -1);
  for (std::size_t j = 1; j < matching.row_of.size(); ++j) {
    if (matching.row_of[j] > 0) column_of[static_cast<std::size_t>(matching.row_of[j]) - 1] = static_cast<int>(j) - 1;
  }
  return column_of;
}

}  // namespace vultus::mocap
