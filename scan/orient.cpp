#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <cstdint>

#include "scan/soup.h"

namespace vultus::scan {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;

// Every directed edge at most once and every vertex with a single fan of triangles.
bool is_oriented_manifold(const Soup& soup) {
  std::vector<std::uint64_t> directed;
  directed.reserve(3 * soup.triangles.size());
  for (const auto& t : soup.triangles)
    for (int k = 0; k < 3; ++k)
      directed.push_back((static_cast<std::uint64_t>(t[k]) << 32) | static_cast<std::uint32_t>(t[(k + 1) % 3]));
  std::sort(directed.begin(), directed.end());
  if (std::adjacent_find(directed.begin(), directed.end()) != directed.end()) return false;
  // A vertex with one fan has no boundary edge leaving it, or one; several fans without boundary are caught by
  // comparing the fan reached from any triangle with the vertex's number of triangles.
  const int vertices = static_cast<int>(soup.positions.rows());
  std::vector<int> offset(vertices + 1, 0), corner(directed.size());
  for (const auto& t : soup.triangles)
    for (int v : t) ++offset[v + 1];
  for (int v = 0; v < vertices; ++v) offset[v + 1] += offset[v];
  std::vector<int> cursor(offset.begin(), offset.end() - 1);
  for (int t = 0; t < static_cast<int>(soup.triangles.size()); ++t)
    for (int k = 0; k < 3; ++k) corner[cursor[soup.triangles[t][k]]++] = 3 * t + k;

  std::vector<std::pair<int, int>> spokes;  // of one vertex: next vertex → previous vertex
  for (int v = 0; v < vertices; ++v) {
    spokes.clear();
    for (int i = offset[v]; i < offset[v + 1]; ++i) {
      const auto& t = soup.triangles[corner[i] / 3];
      const int k = corner[i] % 3;
      spokes.emplace_back(t[(k + 1) % 3], t[(k + 2) % 3]);
    }
    if (spokes.size() < 2) continue;
    std::sort(spokes.begin(), spokes.end());
    auto is_start = [&](int next) {
      return std::none_of(spokes.begin(), spokes.end(), [&](const auto& s) { return s.second == next; });
    };
    const auto border = std::find_if(spokes.begin(), spokes.end(), [&](const auto& s) { return is_start(s.first); });
    const int first = border == spokes.end() ? spokes.front().first : border->first;
    std::size_t reached = 0;
    for (int at = first;;) {
      const auto step = std::lower_bound(spokes.begin(), spokes.end(), std::pair(at, -1));
      if (step == spokes.end() || step->first != at) break;
      ++reached;
      at = step->second;
      if (at == first) break;
    }
    if (reached != spokes.size()) return false;
  }
  return true;
}

// CGAL keeps the order of polygons but may turn them round and use new copies of points; corners are recognized by
// the vertex they are copies of.
void take_corners(Soup& soup, const std::vector<std::vector<std::size_t>>& polygons, const std::vector<int>& original) {
  for (std::size_t t = 0; t < polygons.size(); ++t) {
    const std::array<int, 3> before = soup.triangles[t];
    const std::array<int, 3> uv = soup.uv_rows.empty() ? std::array<int, 3>{} : soup.uv_rows[t];
    for (int k = 0; k < 3; ++k) {
      const int vertex = static_cast<int>(polygons[t][k]);
      soup.triangles[t][k] = vertex;
      if (soup.uv_rows.empty()) continue;
      const auto corner = std::find(before.begin(), before.end(), original[vertex]);
      soup.uv_rows[t][k] = uv[corner - before.begin()];
    }
  }
}

}  // namespace

int orient(Soup& soup) {
  if (is_oriented_manifold(soup)) return 0;
  const int before = static_cast<int>(soup.positions.rows());
  // Only connectivity matters here: x carries the vertex number, so that copies can be traced to their original.
  std::vector<Point> points;
  for (int v = 0; v < before; ++v) points.emplace_back(v, 0, 0);
  std::vector<std::vector<std::size_t>> polygons;
  for (const auto& t : soup.triangles)
    polygons.push_back(
        {static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]), static_cast<std::size_t>(t[2])});
  CGAL::Polygon_mesh_processing::orient_polygon_soup(points, polygons);

  std::vector<int> original;
  for (const Point& point : points) original.push_back(static_cast<int>(point.x()));
  take_corners(soup, polygons, original);
  const bool coloured = soup.colours.rows() == before;
  soup.positions = Points(soup.positions(original, Eigen::all));
  if (coloured) soup.colours = Points(soup.colours(original, Eigen::all));
  return static_cast<int>(points.size()) - before;
}

}  // namespace vultus::scan
