#pragma once

#include <vector>

namespace vultus::apps::bench {

/// The value below which `share` (0 … 1) of `values` lie, interpolated linearly between neighbours in rank (Hyndman
/// and Fan 1996, type 7); NaN for none.
double quantile(std::vector<float> values, double share);
double mean(const std::vector<float>& values);  ///< NaN for none

/// Figures of a set pooled over its cases: a mean of the cases' means, so that every scan weighs the same, and
/// quantiles of all distances together, so that a bad scan shows in the tail as often as it is met.
class Pool {
 public:
  void add(const std::vector<float>& distances);
  bool empty() const { return means_.empty(); }
  double mean() const;                  ///< of the means of the cases; NaN for none
  double quantile(double share) const;  ///< of all distances; NaN for none

 private:
  std::vector<float> means_, all_;
};

}  // namespace vultus::apps::bench
