#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "scan/soup.h"

namespace vultus::scan {
namespace {

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
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
int drop_once(Soup& soup, double factor) {
  const Relief now = relief(soup);
  const double usual = 1.4826 * median(now.height), usual_edge = median(now.edge);
  std::vector<bool> spike(now.height.size());
  int spikes = 0;
  for (std::size_t v = 0; v < spike.size(); ++v) {
    spike[v] = now.height[v] > factor * usual && now.height[v] > 0.8 * usual_edge && now.height[v] > 0.45 * now.edge[v];
    if (!spike[v]) continue;
    ++spikes;
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

}  // namespace

int drop_spikes(Soup& soup, double factor, int passes) {
  int spikes = 0;
  for (int pass = 0; pass < passes; ++pass) {
    const int found = drop_once(soup, factor);
    spikes += found;
    if (found == 0) break;
  }
  return spikes;
}

}  // namespace vultus::scan
