#pragma once

#include <span>
#include <vector>

#include "scan/soup.h"

namespace vultus::scan {

/// Which corners meet at each vertex of a soup. A corner is 3·triangle + its place in the triangle.
class Corners {
 public:
  explicit Corners(const Soup& soup);
  int vertex_count() const { return static_cast<int>(offset_.size()) - 1; }
  /// In rising order.
  std::span<const int> at(int vertex) const {
    return {corner_.data() + offset_[vertex], corner_.data() + offset_[vertex + 1]};
  }

 private:
  std::vector<int> offset_, corner_;
};

}  // namespace vultus::scan
