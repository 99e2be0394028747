#pragma once

#include <Eigen/Core>
#include <vector>

namespace vultus::mocap {

/// The column given to each row so that the sum of `cost` (rows ≤ columns, finite) is least and no column is given
/// twice: shortest augmenting paths (Kuhn 1955; Jonker and Volgenant 1987), O(rows² columns). Throws `UsageError` for
/// more rows than columns.
std::vector<int> least_cost_assignment(const Eigen::MatrixXd& cost);

}  // namespace vultus::mocap
