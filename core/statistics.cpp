#include "core/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace vultus {

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto rank = static_cast<std::ptrdiff_t>(std::floor(q * static_cast<double>(values.size() - 1) + 0.5));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

double quantile(const Eigen::VectorXd& values, double q) {
  return quantile(std::vector<double>(values.data(), values.data() + values.size()), q);
}

double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

}  // namespace vultus
