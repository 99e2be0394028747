#include <tbb/parallel_sort.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <tuple>

#include "scan/soup.h"

namespace vultus::scan {

int drop_non_finite(Soup& soup) {
  std::vector<bool> finite(soup.positions.rows());
  int bad = 0;
  for (int v = 0; v < soup.positions.rows(); ++v) {
    finite[v] = soup.positions.row(v).allFinite();
    if (!finite[v]) ++bad;
  }
  if (bad == 0) return 0;
  std::vector<bool> keep(soup.triangles.size());
  for (std::size_t t = 0; t < keep.size(); ++t) {
    const auto& c = soup.triangles[t];
    keep[t] = finite[c[0]] && finite[c[1]] && finite[c[2]];
  }
  keep_triangles(soup, keep);
  return bad;
}

int merge_equal_vertices(Soup& soup) {
  std::vector<int> order(soup.positions.rows());
  std::iota(order.begin(), order.end(), 0);
  auto key = [&](int v) { return std::tuple(soup.positions(v, 0), soup.positions(v, 1), soup.positions(v, 2)); };
  order.erase(std::remove_if(order.begin(), order.end(), [&](int v) { return !soup.positions.row(v).allFinite(); }),
              order.end());
  tbb::parallel_sort(order.begin(), order.end(), [&](int a, int b) {
    return std::tuple_cat(key(a), std::tuple(a)) < std::tuple_cat(key(b), std::tuple(b));
  });
  std::vector<int> first(soup.positions.rows());
  std::iota(first.begin(), first.end(), 0);
  int merged = 0;
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (key(order[i]) != key(order[i - 1])) continue;
    first[order[i]] = first[order[i - 1]];
    ++merged;
  }
  if (merged > 0)
    for (auto& triangle : soup.triangles)
      for (int& v : triangle) v = first[v];
  return merged;
}

int drop_degenerate(Soup& soup) {
  std::vector<bool> keep(soup.triangles.size());
  for (std::size_t t = 0; t < keep.size(); ++t) {
    const auto& c = soup.triangles[t];
    const Eigen::RowVector3d a = soup.positions.row(c[1]) - soup.positions.row(c[0]);
    const Eigen::RowVector3d b = soup.positions.row(c[2]) - soup.positions.row(c[0]);
    keep[t] = c[0] != c[1] && c[1] != c[2] && c[2] != c[0] && a.cross(b).norm() > 1e-12 * a.norm() * b.norm();
  }
  const int bad = static_cast<int>(std::count(keep.begin(), keep.end(), false));
  if (bad > 0) keep_triangles(soup, keep);
  return bad;
}

int drop_repeated_triangles(Soup& soup) {
  std::vector<std::pair<std::array<int, 3>, int>> sorted;
  sorted.reserve(soup.triangles.size());
  for (int t = 0; t < static_cast<int>(soup.triangles.size()); ++t) {
    std::array<int, 3> corners = soup.triangles[t];
    std::sort(corners.begin(), corners.end());
    sorted.emplace_back(corners, t);
  }
  tbb::parallel_sort(sorted.begin(), sorted.end());
  std::vector<bool> keep(soup.triangles.size(), true);
  int repeated = 0;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    if (sorted[i].first != sorted[i - 1].first) continue;
    keep[sorted[i].second] = false;
    ++repeated;
  }
  if (repeated > 0) keep_triangles(soup, keep);
  return repeated;
}

}  // namespace vultus::scan
