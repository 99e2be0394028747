#include "scan/clean.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "core/error.h"
#include "core/neighbours.h"
#include "scan/soup.h"

namespace vultus::scan {
namespace {

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

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

// Triangles then share the first of several vertices at the same place.
int merge_equal_vertices(Soup& soup) {
  std::vector<int> order(soup.positions.rows());
  std::iota(order.begin(), order.end(), 0);
  auto key = [&](int v) { return std::tuple(soup.positions(v, 0), soup.positions(v, 1), soup.positions(v, 2)); };
  order.erase(std::remove_if(order.begin(), order.end(), [&](int v) { return !soup.positions.row(v).allFinite(); }),
              order.end());
  std::sort(order.begin(), order.end(), [&](int a, int b) {
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
  for (int t = 0; t < static_cast<int>(soup.triangles.size()); ++t) {
    std::array<int, 3> corners = soup.triangles[t];
    std::sort(corners.begin(), corners.end());
    sorted.emplace_back(corners, t);
  }
  std::sort(sorted.begin(), sorted.end());
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

int root_of(std::vector<int>& parent, int v) {
  while (parent[v] != v) v = parent[v] = parent[parent[v]];
  return v;
}

double area(const Soup& soup, int t) {
  const auto& c = soup.triangles[t];
  const Eigen::RowVector3d a = soup.positions.row(c[1]) - soup.positions.row(c[0]);
  const Eigen::RowVector3d b = soup.positions.row(c[2]) - soup.positions.row(c[0]);
  return 0.5 * a.cross(b).norm();
}

void drop_stray_components(Soup& soup, double smallest, CleanReport& report) {
  std::vector<int> parent(soup.positions.rows());
  std::iota(parent.begin(), parent.end(), 0);
  for (const auto& c : soup.triangles) {
    parent[root_of(parent, c[1])] = root_of(parent, c[0]);
    parent[root_of(parent, c[2])] = root_of(parent, c[0]);
  }
  std::vector<double> areas(parent.size(), 0.0);
  for (int t = 0; t < static_cast<int>(soup.triangles.size()); ++t)
    areas[root_of(parent, soup.triangles[t][0])] += area(soup, t);
  const double limit = smallest * (areas.empty() ? 0.0 : *std::max_element(areas.begin(), areas.end()));
  std::vector<bool> keep(soup.triangles.size());
  for (std::size_t t = 0; t < keep.size(); ++t) keep[t] = areas[root_of(parent, soup.triangles[t][0])] >= limit;
  report.stray_triangles = static_cast<int>(std::count(keep.begin(), keep.end(), false));
  report.stray_components =
      static_cast<int>(std::count_if(areas.begin(), areas.end(), [&](double a) { return a > 0.0 && a < limit; }));
  keep_triangles(soup, keep);
}

// Distance of each vertex from its neighbours' centroid along the mean direction of its triangles, and the mean length
// of its edges.
struct Relief {
  std::vector<double> height, edge;
};

Relief relief(const Soup& soup) {
  const int n = static_cast<int>(soup.positions.rows());
  Points sum = Points::Zero(n, 3), normal = Points::Zero(n, 3);
  std::vector<double> length(n, 0.0), count(n, 0.0);
  for (const auto& c : soup.triangles) {
    const Eigen::RowVector3d a = soup.positions.row(c[1]) - soup.positions.row(c[0]);
    const Eigen::RowVector3d b = soup.positions.row(c[2]) - soup.positions.row(c[0]);
    const Eigen::RowVector3d n_t = a.cross(b).normalized();
    for (int k = 0; k < 3; ++k) {
      normal.row(c[k]) += n_t;
      for (int other : {c[(k + 1) % 3], c[(k + 2) % 3]}) {
        sum.row(c[k]) += soup.positions.row(other);
        length[c[k]] += (soup.positions.row(other) - soup.positions.row(c[k])).norm();
        count[c[k]] += 1.0;
      }
    }
  }
  Relief result{std::vector<double>(n, 0.0), std::vector<double>(n, 0.0)};
  for (int v = 0; v < n; ++v) {
    if (count[v] == 0.0) continue;
    const Eigen::RowVector3d offset = soup.positions.row(v) - sum.row(v) / count[v];
    const double norm = normal.row(v).norm();
    // A needle's normals cancel out: its whole offset counts then.
    result.height[v] = norm > 0.3 * 0.5 * count[v] ? std::abs(offset.dot(normal.row(v)) / norm) : offset.norm();
    result.edge[v] = length[v] / count[v];
  }
  return result;
}

// A spike stands out from the scan's usual roughness and is steep as well, so that a coarse mesh's nose is none.
int drop_spikes(Soup& soup, double factor, std::vector<bool>& gone) {
  const Relief now = relief(soup);
  const double usual = 1.4826 * median(now.height), usual_edge = median(now.edge);
  std::vector<bool> spike(now.height.size());
  int spikes = 0;
  for (std::size_t v = 0; v < spike.size(); ++v) {
    spike[v] = now.height[v] > factor * usual && now.height[v] > 0.8 * usual_edge && now.height[v] > 0.45 * now.edge[v];
    if (!spike[v]) continue;
    ++spikes;
    gone[v] = true;
  }
  if (spikes == 0) return 0;
  std::vector<bool> keep(soup.triangles.size());
  for (std::size_t t = 0; t < keep.size(); ++t) {
    const auto& c = soup.triangles[t];
    keep[t] = !spike[c[0]] && !spike[c[1]] && !spike[c[2]];
  }
  keep_triangles(soup, keep);
  return spikes;
}

Mesh mesh_from(Soup&& soup, const Mesh& raw) {
  TopologyData data;
  data.vertex_count = static_cast<int>(soup.positions.rows());
  data.face_offsets.reserve(soup.triangles.size() + 1);
  data.face_offsets.push_back(0);
  data.corner_vertex.reserve(3 * soup.triangles.size());
  for (const auto& triangle : soup.triangles) {
    data.corner_vertex.insert(data.corner_vertex.end(), triangle.begin(), triangle.end());
    data.face_offsets.push_back(static_cast<int>(data.corner_vertex.size()));
  }
  if (!soup.uv_rows.empty()) {
    data.uvs = raw.topology->uvs();
    for (const auto& row : soup.uv_rows) data.corner_uv.insert(data.corner_uv.end(), row.begin(), row.end());
  }
  Mesh mesh;
  mesh.topology = Topology::make(std::move(data));
  mesh.positions = std::move(soup.positions);
  mesh.colours = std::move(soup.colours);
  mesh.texture = soup.uv_rows.empty() ? std::string() : raw.texture;
  return mesh;
}

int count_boundaries(const Soup& soup) {
  // Union-find over the vertices of open edges: each group is one border (or several that touch).
  std::vector<std::pair<int, int>> directed;
  for (const auto& c : soup.triangles)
    for (int k = 0; k < 3; ++k) directed.emplace_back(c[k], c[(k + 1) % 3]);
  std::sort(directed.begin(), directed.end());
  std::vector<int> parent(soup.positions.rows());
  std::iota(parent.begin(), parent.end(), 0);
  std::vector<bool> open(parent.size(), false);
  for (const auto& [a, b] : directed) {
    if (std::binary_search(directed.begin(), directed.end(), std::pair(b, a))) continue;
    open[a] = open[b] = true;
    parent[root_of(parent, a)] = root_of(parent, b);
  }
  int boundaries = 0;
  for (int v = 0; v < static_cast<int>(parent.size()); ++v)
    if (open[v] && root_of(parent, v) == v) ++boundaries;
  return boundaries;
}

// The vertices of `before` that no triangle uses any more.
Points removed_points(const Points& before, const Soup& soup) {
  std::vector<bool> used(before.rows(), false);
  for (const auto& triangle : soup.triangles)
    for (int v : triangle)
      if (v < before.rows()) used[v] = true;
  std::vector<int> rows;
  for (int v = 0; v < before.rows(); ++v)
    if (!used[v] && before.row(v).allFinite()) rows.push_back(v);
  return before(rows, Eigen::all);
}

}  // namespace

Units guess_units(const Points& positions) {
  std::vector<int> finite;
  for (int v = 0; v < positions.rows(); ++v)
    if (positions.row(v).allFinite()) finite.push_back(v);
  if (finite.empty()) throw InputError("units cannot be guessed: no finite vertex");
  // A few stray points must not decide: the box of the middle 98 % along each axis.
  Eigen::Vector3d size;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (int v : finite) values.push_back(positions(v, axis));
    std::sort(values.begin(), values.end());
    const std::size_t cut = values.size() / 100;
    size[axis] = values[values.size() - 1 - cut] - values[cut];
  }
  const double diagonal = size.norm();
  for (const auto& [name, scale] : {std::pair("mm", 1.0), std::pair("cm", 10.0), std::pair("m", 1000.0)})
    if (diagonal * scale >= 120.0 && diagonal * scale < 1200.0) return {name, scale, true};
  return {"unknown, taken as mm", 1.0, false};
}

void CleanOptions::validate() const {
  if (!(mm_per_unit >= 0.0) || !std::isfinite(mm_per_unit))
    throw InputError("cleaning: millimetres per unit must be positive");
  if (!(smallest_component >= 0.0 && smallest_component <= 1.0))
    throw InputError("cleaning: the smallest component must be a share from 0 to 1");
  if (!(spike_factor > 1.0)) throw InputError("cleaning: the spike factor must be above 1");
  if (!(largest_filled_hole >= 0.0)) throw InputError("cleaning: the largest hole to fill cannot be negative");
  if (!(target_triangles >= 0.0)) throw InputError("cleaning: the number of triangles cannot be negative");
}

std::vector<std::string> CleanReport::lines() const {
  std::vector<std::string> text;
  text.push_back("units: " + units.name + (units.certain ? "" : " (size fits no head)"));
  auto say = [&](int count, const std::string& what) {
    if (count > 0) text.push_back(std::to_string(count) + " " + what);
  };
  say(non_finite_vertices, "vertices were not finite");
  say(duplicate_vertices, "vertices repeated others and were merged");
  say(degenerate_triangles, "triangles without area removed");
  say(duplicate_triangles, "triangles repeated others and were removed");
  say(non_manifold_splits, "vertices split where sheets met in one edge or point");
  say(stray_triangles, "triangles in " + std::to_string(stray_components) + " stray pieces removed");
  say(spike_vertices, "spikes removed");
  say(unused_vertices, "vertices without triangles left out");
  say(holes_filled, "holes filled with " + std::to_string(invented_triangles) + " invented triangles");
  say(open_boundaries, "holes and borders left open");
  text.push_back(std::to_string(vertices_after) + " of " + std::to_string(vertices_before) + " vertices and " +
                 std::to_string(triangles_after) + " of " + std::to_string(triangles_before) + " triangles kept");
  return text;
}

CleanScan clean_scan(const Mesh& raw, const CleanOptions& options, Progress& progress) {
  options.validate();
  Soup soup = soup_from(raw);
  CleanScan result;
  CleanReport& report = result.report;
  report.vertices_before = static_cast<int>(soup.positions.rows());
  report.triangles_before = static_cast<int>(soup.triangles.size());
  if (soup.triangles.empty()) throw InputError("scan has no triangles to clean");
  report.units = guess_units(soup.positions);
  if (options.mm_per_unit > 0.0) report.units = {"as told", options.mm_per_unit, true};
  soup.positions *= report.units.mm_per_unit;
  const Points before = soup.positions;
  progress.check();

  report.non_finite_vertices = drop_non_finite(soup);
  report.duplicate_vertices = merge_equal_vertices(soup);
  report.degenerate_triangles = drop_degenerate(soup);
  report.duplicate_triangles = drop_repeated_triangles(soup);
  std::vector<bool> spikes(soup.positions.rows(), false);
  for (int pass = 0; pass < 3; ++pass) {
    const int found = drop_spikes(soup, options.spike_factor, spikes);
    report.spike_vertices += found;
    if (found == 0) break;
  }
  progress.check();
  // Pieces are told apart after sheets that only touch have been taken apart and spikes' stumps cut loose.
  report.non_manifold_splits = orient(soup);
  drop_stray_components(soup, options.smallest_component, report);
  if (soup.triangles.empty()) throw InputError("nothing of the scan is left after cleaning");
  result.removed = removed_points(before, soup);
  report.unused_vertices =
      drop_unused(soup) - report.spike_vertices - report.duplicate_vertices - report.non_finite_vertices;
  report.unused_vertices = std::max(0, report.unused_vertices);
  progress.check();

  if (options.target_triangles > 0.0) decimate(soup, static_cast<int>(options.target_triangles));
  const std::size_t measured = soup.triangles.size();
  if (options.largest_filled_hole > 0.0) report.holes_filled = fill_holes(soup, options.largest_filled_hole);
  report.invented_triangles = static_cast<int>(soup.triangles.size() - measured);
  result.invented.assign(soup.triangles.size(), false);
  std::fill(result.invented.begin() + measured, result.invented.end(), true);
  report.open_boundaries = count_boundaries(soup);
  report.vertices_after = static_cast<int>(soup.positions.rows());
  report.triangles_after = static_cast<int>(soup.triangles.size());
  result.mesh = mesh_from(std::move(soup), raw);
  for (const std::string& line : report.lines()) progress.note(line);
  return result;
}

}  // namespace vultus::scan
