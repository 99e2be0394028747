#include "register/template_orient.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <map>

namespace vultus::registration::layout {
namespace {

using Edge = std::pair<int, int>;

std::map<Edge, std::vector<int>> triangles_of_edges(const Weave& weave) {
  std::map<Edge, std::vector<int>> of_edge;
  for (int t = 0; t < static_cast<int>(weave.triangles.size()); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(weave.triangles[t][k], weave.triangles[t][(k + 1) % 3]);
      of_edge[{low, high}].push_back(t);
    }
  return of_edge;
}

bool runs(const std::array<int, 3>& t, int from, int to) {
  return (t[0] == from && t[1] == to) || (t[1] == from && t[2] == to) || (t[2] == from && t[0] == to);
}

/// Orients everything connected to `seed` like it; returns those triangles.
std::vector<int> orient_component(Weave& weave, const std::map<Edge, std::vector<int>>& of_edge, int seed,
                                  std::vector<bool>& seen) {
  std::vector<int> component = {seed};
  seen[seed] = true;
  for (std::size_t next = 0; next < component.size(); ++next) {
    const auto current = weave.triangles[component[next]];
    for (int k = 0; k < 3; ++k) {
      const int a = current[k], b = current[(k + 1) % 3];
      const auto [low, high] = std::minmax(a, b);
      const auto& sharing = of_edge.at({low, high});
      assert(sharing.size() <= 2);
      for (const int t : sharing) {
        if (seen[t]) continue;
        if (runs(weave.triangles[t], a, b)) std::swap(weave.triangles[t][1], weave.triangles[t][2]);
        seen[t] = true;
        component.push_back(t);
      }
    }
  }
  return component;
}

/// Positive when the triangles face away from the mean of their corners.
double outwardness(const Weave& weave, const std::vector<int>& component) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const int t : component)
    for (const int v : weave.triangles[t]) middle += weave.position[v] / (3.0 * static_cast<double>(component.size()));
  double sum = 0.0;
  for (const int t : component) {
    const auto& [a, b, c] = weave.triangles[t];
    const Eigen::Vector3d p = weave.position[a] - middle, q = weave.position[b] - middle,
                          r = weave.position[c] - middle;
    sum += p.dot(q.cross(r));
  }
  return sum;
}

}  // namespace

void orient_outward(Weave& weave) {
  const auto of_edge = triangles_of_edges(weave);
  std::vector<bool> seen(weave.triangles.size(), false);
  for (int t = 0; t < static_cast<int>(weave.triangles.size()); ++t) {
    if (seen[t]) continue;
    const auto component = orient_component(weave, of_edge, t, seen);
    if (outwardness(weave, component) >= 0.0) continue;
    for (const int c : component) std::swap(weave.triangles[c][1], weave.triangles[c][2]);
  }
}

}  // namespace vultus::registration::layout
