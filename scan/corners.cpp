#include "scan/corners.h"

#include <numeric>

namespace vultus::scan {

Corners::Corners(const Soup& soup) : offset_(soup.positions.rows() + 1, 0), corner_(3 * soup.triangles.size()) {
  for (const auto& triangle : soup.triangles)
    for (const int v : triangle) ++offset_[v + 1];
  std::partial_sum(offset_.begin(), offset_.end(), offset_.begin());
  std::vector<int> next(offset_.begin(), offset_.end() - 1);
  int corner = 0;
  for (const auto& triangle : soup.triangles)
    for (const int v : triangle) corner_[next[v]++] = corner++;
}

}  // namespace vultus::scan
