#pragma once

#include <span>
#include <vector>

namespace vultus {

/// Which corners of triangles meet at each vertex. A corner is 3·triangle + its place in the triangle.
class Corners {
 public:
  /// `corner_vertex`: the vertex of each corner, triangle after triangle, each below `vertex_count`.
  Corners(int vertex_count, std::span<const int> corner_vertex);
  int vertex_count() const { return static_cast<int>(offset_.size()) - 1; }
  /// In rising order.
  std::span<const int> at(int vertex) const {
    return {corner_.data() + offset_[vertex], corner_.data() + offset_[vertex + 1]};
  }

 private:
  std::vector<int> offset_, corner_;
};

}  // namespace vultus
