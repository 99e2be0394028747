#include "scan/soup.h"

namespace vultus::scan {

Soup soup_from(const Mesh& mesh) {
  Soup soup;
  soup.positions = mesh.positions;
  if (mesh.has_colours()) soup.colours = mesh.colours;
  const Triangles& triangles = mesh.topology->triangles();
  const Triangles& uvs = mesh.topology->triangle_uvs();
  soup.triangles.reserve(triangles.rows());
  for (int t = 0; t < triangles.rows(); ++t)
    soup.triangles.push_back({triangles(t, 0), triangles(t, 1), triangles(t, 2)});
  for (int t = 0; t < uvs.rows(); ++t) soup.uv_rows.push_back({uvs(t, 0), uvs(t, 1), uvs(t, 2)});
  return soup;
}

Corners vertex_corners(const Soup& soup) {
  const std::span<const int> corners(soup.triangles.empty() ? nullptr : soup.triangles.front().data(),
                                     3 * soup.triangles.size());
  return {static_cast<int>(soup.positions.rows()), corners};
}

void keep_triangles(Soup& soup, const std::vector<bool>& keep) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    if (!keep[t]) continue;
    soup.triangles[kept] = soup.triangles[t];
    if (!soup.uv_rows.empty()) soup.uv_rows[kept] = soup.uv_rows[t];
    ++kept;
  }
  soup.triangles.resize(kept);
  if (!soup.uv_rows.empty()) soup.uv_rows.resize(kept);
}

int drop_unused(Soup& soup) {
  std::vector<int> number(soup.positions.rows(), -1);
  for (const auto& triangle : soup.triangles)
    for (int v : triangle) number[v] = 0;
  std::vector<int> kept;
  for (int v = 0; v < static_cast<int>(number.size()); ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<int>(kept.size());
    kept.push_back(v);
  }
  const int dropped = static_cast<int>(number.size() - kept.size());
  if (dropped == 0) return 0;
  for (auto& triangle : soup.triangles)
    for (int& v : triangle) v = number[v];
  const bool coloured = soup.colours.rows() == soup.positions.rows();
  soup.positions = Points(soup.positions(kept, Eigen::all));
  if (coloured) soup.colours = Points(soup.colours(kept, Eigen::all));
  return dropped;
}

}  // namespace vultus::scan
