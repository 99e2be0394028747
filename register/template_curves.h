#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <utility>
#include <vector>

namespace vultus::registration::shape {

/// Points 0 … count-1 of the natural-parameter Catmull–Rom curve through (parameter, point) keys in rising order.
inline std::vector<Eigen::Vector3d> through(const std::vector<std::pair<double, Eigen::Vector3d>>& keys, int count) {
  const int last = static_cast<int>(keys.size()) - 1;
  const auto tangent = [&](int k) -> Eigen::Vector3d {
    if (last == 1) return (keys[1].second - keys[0].second) / (keys[1].first - keys[0].first);
    const int m = std::clamp(k, 1, last - 1);
    const auto& [ta, a] = keys[m - 1];
    const auto& [tb, b] = keys[m];
    const auto& [tc, c] = keys[m + 1];
    const Eigen::Vector3d ab = (b - a) / (tb - ta), bc = (c - b) / (tc - tb);
    const Eigen::Vector3d mid = (ab * (tc - tb) + bc * (tb - ta)) / (tc - ta);
    if (k < m) return 2.0 * ab - mid;
    if (k > m) return 2.0 * bc - mid;
    return mid;
  };
  std::vector<Eigen::Vector3d> points(count);
  for (int i = 0; i < count; ++i) {
    int k = 0;
    while (k < last - 1 && i > keys[k + 1].first) ++k;
    const double h = keys[k + 1].first - keys[k].first, t = (i - keys[k].first) / h;
    const double t2 = t * t, t3 = t2 * t;
    points[i] = (2 * t3 - 3 * t2 + 1) * keys[k].second + (t3 - 2 * t2 + t) * h * tangent(k) +
                (3 * t2 - 2 * t3) * keys[k + 1].second + (t3 - t2) * h * tangent(k + 1);
  }
  return points;
}

}  // namespace vultus::registration::shape
