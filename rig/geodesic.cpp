#include "rig/geodesic.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <tuple>

#include "core/error.h"

namespace vultus::rig {
namespace {

std::vector<int> way_between(const Adjacency& adjacency, const Points& positions, int from, int to,
                             const std::vector<bool>& allowed) {
  const int sources[] = {from};
  const EdgeDistances ways = edge_distances(adjacency, positions, sources, allowed);
  if (ways.source[to] < 0)
    throw InputError("landmark vertices " + std::to_string(from) + " and " + std::to_string(to) +
                     " are not connected along the mesh");
  std::vector<int> way;
  for (int v = to; v >= 0; v = ways.previous[v]) way.push_back(v);
  return way;
}

void sort_unique(std::vector<int>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace

EdgeDistances edge_distances(const Adjacency& adjacency, const Points& positions, std::span<const int> sources,
                             const std::vector<bool>& allowed) {
  const auto count = static_cast<std::size_t>(positions.rows());
  EdgeDistances result{std::vector<double>(count, std::numeric_limits<double>::infinity()), std::vector<int>(count, -1),
                       std::vector<int>(count, -1)};
  using Entry = std::tuple<double, int, int>;  // distance, source, vertex: equal distances settle by source
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (std::size_t s = 0; s < sources.size(); ++s) {
    if (result.source[sources[s]] >= 0 || (!allowed.empty() && !allowed[sources[s]])) continue;
    result.distance[sources[s]] = 0.0;
    result.source[sources[s]] = static_cast<int>(s);
    queue.emplace(0.0, static_cast<int>(s), sources[s]);
  }
  while (!queue.empty()) {
    const auto [distance, source, v] = queue.top();
    queue.pop();
    if (distance > result.distance[v] || source != result.source[v]) continue;
    for (int neighbour : adjacency.of(v)) {
      if (!allowed.empty() && !allowed[neighbour]) continue;
      const double reached = distance + (positions.row(neighbour) - positions.row(v)).norm();
      if (std::tie(reached, source) >= std::tie(result.distance[neighbour], result.source[neighbour])) continue;
      result.distance[neighbour] = reached;
      result.source[neighbour] = source;
      result.previous[neighbour] = v;
      queue.emplace(reached, source, neighbour);
    }
  }
  return result;
}

std::vector<int> closed_contour(const Adjacency& adjacency, const Points& positions, std::span<const int> ring,
                                const std::vector<bool>& allowed) {
  std::vector<int> contour;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const std::vector<int> way = way_between(adjacency, positions, ring[i], ring[(i + 1) % ring.size()], allowed);
    contour.insert(contour.end(), way.begin(), way.end());
  }
  sort_unique(contour);
  return contour;
}

std::vector<int> inside_contour(const Adjacency& adjacency, std::span<const int> contour, std::span<const int> seeds,
                                const std::vector<bool>& allowed) {
  std::vector<int> inside(contour.begin(), contour.end());
  std::vector<bool> seen(adjacency.offsets.size() - 1, false);
  for (int v : contour) seen[v] = true;
  std::vector<int> open;
  const auto visit = [&](int v) {
    if (seen[v] || (!allowed.empty() && !allowed[v])) return;
    seen[v] = true;
    open.push_back(v);
    inside.push_back(v);
  };
  for (int v : seeds) visit(v);
  while (!open.empty()) {
    const int v = open.back();
    open.pop_back();
    for (int neighbour : adjacency.of(v)) visit(neighbour);
  }
  sort_unique(inside);
  return inside;
}

}  // namespace vultus::rig
