#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Simple_cartesian.h>
#include <tbb/blocked_range.h>
#include <tbb/combinable.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <numeric>
#include <optional>

#include "scan/soup.h"

namespace vultus::scan {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;

// Tells the fans of triangles at a vertex apart; keeps its memory from one vertex to the next.
class Fans {
 public:
  explicit Fans(const Soup& soup) : soup_(soup) {}

  // False where two triangles run along one edge in the same direction; there are no fans then.
  bool find(std::span<const int> corners) {
    const auto n = static_cast<int>(corners.size());
    leaving_.clear();
    entering_.clear();
    for (int i = 0; i < n; ++i) {
      const auto& triangle = soup_.triangles[corners[i] / 3];
      leaving_.emplace_back(triangle[(corners[i] + 1) % 3], i);
      entering_.emplace_back(triangle[(corners[i] + 2) % 3], i);
    }
    std::sort(leaving_.begin(), leaving_.end());
    std::sort(entering_.begin(), entering_.end());
    const auto same_edge = [](const auto& a, const auto& b) { return a.first == b.first; };
    if (std::adjacent_find(leaving_.begin(), leaving_.end(), same_edge) != leaving_.end() ||
        std::adjacent_find(entering_.begin(), entering_.end(), same_edge) != entering_.end())
      return false;
    link(n);
    return true;
  }
  int count() const { return count_; }
  const std::vector<int>& of_corner() const { return of_corner_; }  // in the order of corners, from 0

 private:
  void link(int n) {
    next_.assign(n, -1);
    previous_.assign(n, -1);
    auto left = leaving_.begin();
    for (const auto& [vertex, i] : entering_) {
      while (left != leaving_.end() && left->first < vertex) ++left;
      if (left == leaving_.end() || left->first != vertex) continue;
      next_[i] = left->second;
      previous_[left->second] = i;
    }
    count_ = 0;
    of_corner_.assign(n, -1);
    for (int first = 0; first < n; ++first) {
      if (of_corner_[first] >= 0) continue;
      for (int i = first; i >= 0 && of_corner_[i] < 0; i = next_[i]) of_corner_[i] = count_;
      for (int i = previous_[first]; i >= 0 && of_corner_[i] < 0; i = previous_[i]) of_corner_[i] = count_;
      ++count_;
    }
  }

  const Soup& soup_;
  std::vector<std::pair<int, int>> leaving_, entering_;  // neighbour along an edge, corner
  std::vector<int> next_, previous_, of_corner_;
  int count_ = 0;
};

// A corner (3·triangle + place) and its fan at the vertex, for fans beyond the first.
struct Parting {
  int corner, fan;
};

// What stands in the way of one fan a vertex, in the order of corners; nothing where triangles are not turned alike.
std::optional<std::vector<Parting>> partings(const Soup& soup) {
  const Corners corners = vertex_corners(soup);
  tbb::combinable<std::vector<Parting>> found;
  std::atomic<bool> oriented = true;
  tbb::parallel_for(tbb::blocked_range<int>(0, corners.vertex_count(), 4096), [&](const auto& range) {
    Fans fans(soup);
    for (int v = range.begin(); v < range.end() && oriented; ++v) {
      if (!fans.find(corners.at(v))) oriented = false;
      for (std::size_t i = 0; oriented && fans.count() > 1 && i < corners.at(v).size(); ++i)
        if (fans.of_corner()[i] > 0) found.local().push_back({corners.at(v)[i], fans.of_corner()[i]});
    }
  });
  if (!oriented) return {};
  std::vector<Parting> all;
  found.combine_each([&](const auto& some) { all.insert(all.end(), some.begin(), some.end()); });
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.corner < b.corner; });
  return all;
}

// Positions and colours of the soup's rows `original`.
void take_rows(Soup& soup, const std::vector<int>& original) {
  const bool coloured = soup.colours.rows() == soup.positions.rows();
  soup.positions = Points(soup.positions(original, Eigen::all));
  if (coloured) soup.colours = Points(soup.colours(original, Eigen::all));
}

// Every fan beyond a vertex's first gets a copy of the vertex.
int part(Soup& soup, const std::vector<Parting>& partings) {
  if (partings.empty()) return 0;
  const auto before = static_cast<int>(soup.positions.rows());
  std::vector<int> original(before);
  std::iota(original.begin(), original.end(), 0);
  std::map<std::pair<int, int>, int> copy;  // of a vertex's fan
  for (const auto& [corner, fan] : partings) {
    int& vertex = soup.triangles[corner / 3][corner % 3];
    const auto [place, is_new] = copy.try_emplace({vertex, fan}, static_cast<int>(original.size()));
    if (is_new) original.push_back(vertex);
    vertex = place->second;
  }
  take_rows(soup, original);
  return static_cast<int>(original.size()) - before;
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
  if (const auto apart = partings(soup)) return part(soup, *apart);
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
  take_rows(soup, original);
  return static_cast<int>(points.size()) - before;
}

}  // namespace vultus::scan
