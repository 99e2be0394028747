#pragma once

#include <Eigen/Core>
#include <vector>

namespace vultus {

/// Value below which the fraction `q` of the values lies (nearest rank); NaN without values.
double quantile(std::vector<double> values, double q);
double quantile(const Eigen::VectorXd& values, double q);
double median(std::vector<double> values);  ///< the upper one of an even number

}  // namespace vultus
