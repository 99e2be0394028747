#include "apps/bench_registration/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace vultus::apps::bench {

double quantile(std::vector<float> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double rank = share * static_cast<double>(values.size() - 1);
  const auto below = values.begin() + static_cast<std::ptrdiff_t>(std::floor(rank));
  std::nth_element(values.begin(), below, values.end());
  if (below + 1 == values.end()) return *below;
  const double next = *std::min_element(below + 1, values.end());
  return *below + (rank - std::floor(rank)) * (next - *below);
}

double mean(const std::vector<float>& values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

void Pool::add(const std::vector<float>& distances) {
  if (distances.empty()) return;
  means_.push_back(static_cast<float>(bench::mean(distances)));
  all_.insert(all_.end(), distances.begin(), distances.end());
}

double Pool::mean() const { return bench::mean(means_); }
double Pool::quantile(double share) const { return bench::quantile(all_, share); }

}  // namespace vultus::apps::bench
