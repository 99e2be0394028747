#include "register/crumples.h"

#include <algorithm>
#include <cstdint>

namespace vultus::registration {
namespace {

struct Side {
  std::uint64_t edge;
  int triangle;
};

std::vector<Side> sides_by_edge(const Triangles& triangles) {
  std::vector<Side> sides;
  sides.reserve(3 * triangles.rows());
  for (int t = 0; t < triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax({triangles(t, k), triangles(t, (k + 1) % 3)});
      sides.push_back({(static_cast<std::uint64_t>(a) << 32) | static_cast<std::uint32_t>(b), t});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& one, const Side& other) {
    return one.edge != other.edge ? one.edge < other.edge : one.triangle < other.triangle;
  });
  return sides;
}

}  // namespace

std::vector<bool> crumpled_triangles(const Topology& topology, const Points& reference, const Points& positions) {
  constexpr double smooth = 0.5, crumpled = 0.0;  // cosines of 60 and 90 degrees
  const Points before = triangle_normals(topology, reference), now = triangle_normals(topology, positions);
  std::vector<bool> flags(topology.triangles().rows(), false);
  const std::vector<Side> sides = sides_by_edge(topology.triangles());
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i;
    while (end < sides.size() && sides[end].edge == sides[i].edge) ++end;
    const int a = sides[i].triangle, b = sides[end - 1].triangle;
    if (end - i == 2 && before.row(a).dot(before.row(b)) > smooth && now.row(a).dot(now.row(b)) < crumpled)
      flags[a] = flags[b] = true;
    i = end;
  }
  return flags;
}

}  // namespace vultus::registration
