#include <tbb/parallel_sort.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "scan/soup.h"

namespace vultus::scan {
namespace {

int root_of(std::vector<int>& parent, int v) {
  while (parent[v] != v) v = parent[v] = parent[parent[v]];
  return v;
}

std::uint64_t edge_key(int a, int b) {
  return (static_cast<std::uint64_t>(std::min(a, b)) << 32) | static_cast<std::uint32_t>(std::max(a, b));
}

// Length of open edges of each piece but the largest, whose border matters to nobody.
std::vector<double> border_lengths(const Soup& soup, const Pieces& pieces, double largest) {
  std::vector<std::pair<std::uint64_t, int>> edges;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    const auto& c = soup.triangles[t];
    if (pieces.area[pieces.of_triangle[t]] == largest) continue;
    for (int k = 0; k < 3; ++k) edges.emplace_back(edge_key(c[k], c[(k + 1) % 3]), pieces.of_triangle[t]);
  }
  std::sort(edges.begin(), edges.end());
  std::vector<double> lengths(pieces.area.size(), 0.0);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto& [key, piece] = edges[i];
    if ((i > 0 && edges[i - 1].first == key) || (i + 1 < edges.size() && edges[i + 1].first == key)) continue;
    const auto a = static_cast<int>(key >> 32), b = static_cast<int>(key & 0xffffffffu);
    lengths[piece] += (soup.positions.row(a) - soup.positions.row(b)).norm();
  }
  return lengths;
}

}  // namespace

Pieces pieces_of(const Soup& soup) {
  std::vector<int> parent(soup.positions.rows());
  std::iota(parent.begin(), parent.end(), 0);
  for (const auto& c : soup.triangles) {
    parent[root_of(parent, c[1])] = root_of(parent, c[0]);
    parent[root_of(parent, c[2])] = root_of(parent, c[0]);
  }
  Pieces pieces;
  std::vector<int> number(parent.size(), -1);
  pieces.of_triangle.reserve(soup.triangles.size());
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    int& piece = number[root_of(parent, soup.triangles[t][0])];
    if (piece < 0) {
      piece = static_cast<int>(pieces.area.size());
      pieces.area.push_back(0.0);
    }
    pieces.of_triangle.push_back(piece);
    pieces.area[piece] += area_vector(soup, static_cast<int>(t)).norm();
  }
  return pieces;
}

Eigen::RowVector3d area_vector(const Soup& soup, int t) {
  const auto& c = soup.triangles[t];
  const Eigen::RowVector3d a = soup.positions.row(c[1]) - soup.positions.row(c[0]);
  const Eigen::RowVector3d b = soup.positions.row(c[2]) - soup.positions.row(c[0]);
  return 0.5 * a.cross(b);
}

StrayPieces drop_stray_pieces(Soup& soup, double smallest) {
  const Pieces pieces = pieces_of(soup);
  StrayPieces stray;
  if (pieces.area.size() < 2) return stray;
  const double largest = *std::max_element(pieces.area.begin(), pieces.area.end());
  const std::vector<double> border = border_lengths(soup, pieces, largest);
  std::vector<bool> is_stray(pieces.area.size());
  for (std::size_t p = 0; p < is_stray.size(); ++p) {
    // Shreds: a disc has 0.08 here, a strip twelve times as long as wide 0.018.
    const bool is_shredded = pieces.area[p] < 0.3 * largest && pieces.area[p] < 0.006 * border[p] * border[p];
    is_stray[p] = pieces.area[p] < smallest * largest || (smallest > 0.0 && is_shredded);
    stray.pieces += is_stray[p];
  }
  std::vector<bool> keep(soup.triangles.size());
  for (std::size_t t = 0; t < keep.size(); ++t) keep[t] = !is_stray[pieces.of_triangle[t]];
  stray.triangles = static_cast<int>(std::count(keep.begin(), keep.end(), false));
  keep_triangles(soup, keep);
  return stray;
}

int count_large_pieces(const Soup& soup, double share, double least_diagonal) {
  const Pieces pieces = pieces_of(soup);
  if (pieces.area.empty()) return 0;
  const double limit = share * *std::max_element(pieces.area.begin(), pieces.area.end());
  std::vector<Eigen::AlignedBox3d> boxes(pieces.area.size());
  for (std::size_t t = 0; t < soup.triangles.size(); ++t)
    for (int v : soup.triangles[t]) boxes[pieces.of_triangle[t]].extend(soup.positions.row(v).transpose());
  int large = 0;
  for (std::size_t p = 0; p < boxes.size(); ++p)
    large += pieces.area[p] >= limit && boxes[p].diagonal().norm() >= least_diagonal;
  return large;
}

bool turn_outwards(Soup& soup) {
  const Pieces pieces = pieces_of(soup);
  if (pieces.area.empty()) return false;
  const auto main = std::max_element(pieces.area.begin(), pieces.area.end()) - pieces.area.begin();
  const auto centre_of = [&](std::size_t t) -> Eigen::RowVector3d {
    const auto& c = soup.triangles[t];
    return (soup.positions.row(c[0]) + soup.positions.row(c[1]) + soup.positions.row(c[2])) / 3.0;
  };
  Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
  for (std::size_t t = 0; t < soup.triangles.size(); ++t)
    if (pieces.of_triangle[t] == main)
      centre += area_vector(soup, static_cast<int>(t)).norm() / pieces.area[main] * centre_of(t);
  double outwards = 0.0, most = 0.0;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    if (pieces.of_triangle[t] != main) continue;
    const Eigen::RowVector3d area = area_vector(soup, static_cast<int>(t)), arm = centre_of(t) - centre;
    outwards += area.dot(arm);
    most += area.norm() * arm.norm();
  }
  if (outwards >= -0.05 * most) return false;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    std::swap(soup.triangles[t][1], soup.triangles[t][2]);
    if (!soup.uv_rows.empty()) std::swap(soup.uv_rows[t][1], soup.uv_rows[t][2]);
  }
  return true;
}

int count_boundaries(const Soup& soup) {
  // Edges as sorted keys: those without their opposite are open. Union-find over their ends: each group is one border
  // (or several that touch).
  std::vector<std::uint64_t> directed;
  directed.reserve(3 * soup.triangles.size());
  for (const auto& c : soup.triangles)
    for (int k = 0; k < 3; ++k) directed.push_back(edge_key(c[k], c[(k + 1) % 3]));
  tbb::parallel_sort(directed.begin(), directed.end());
  std::vector<int> parent(soup.positions.rows());
  std::iota(parent.begin(), parent.end(), 0);
  std::vector<bool> open(parent.size(), false);
  for (std::size_t i = 0; i < directed.size(); ++i) {
    if ((i > 0 && directed[i - 1] == directed[i]) || (i + 1 < directed.size() && directed[i + 1] == directed[i]))
      continue;
    const int a = static_cast<int>(directed[i] >> 32), b = static_cast<int>(directed[i] & 0xffffffffu);
    open[a] = open[b] = true;
    parent[root_of(parent, a)] = root_of(parent, b);
  }
  int boundaries = 0;
  for (int v = 0; v < static_cast<int>(parent.size()); ++v) boundaries += open[v] && root_of(parent, v) == v;
  return boundaries;
}

}  // namespace vultus::scan
