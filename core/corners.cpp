#include "core/corners.h"

#include <numeric>

namespace vultus {

Corners::Corners(int vertex_count, std::span<const int> corner_vertex)
    : offset_(vertex_count + 1, 0), corner_(corner_vertex.size()) {
  for (const int v : corner_vertex) ++offset_[v + 1];
  std::partial_sum(offset_.begin(), offset_.end(), offset_.begin());
  std::vector<int> next(offset_.begin(), offset_.end() - 1);
  int corner = 0;
  for (const int v : corner_vertex) corner_[next[v]++] = corner++;
}

}  // namespace vultus
