#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/statistics.h"
#include "scan/soup.h"

namespace vultus::scan {
namespace {

// Distance of each vertex from its neighbours' centroid along the mean direction of its triangles, and the mean length
// of its edges.
struct Relief {
  std::vector<double> height, edge;
};

Relief relief(const Soup& soup, const Corners& corners) {
  const int n = corners.vertex_count();
  Points normals(soup.triangles.size(), 3);
  tbb::parallel_for(Eigen::Index{0}, normals.rows(),
                    [&](Eigen::Index t) { normals.row(t) = area_vector(soup, static_cast<int>(t)).normalized(); });
  Relief result{std::vector<double>(n, 0.0), std::vector<double>(n, 0.0)};
  tbb::parallel_for(0, n, [&](int v) {
    const std::span<const int> around = corners.at(v);
    if (around.empty()) return;
    const Eigen::RowVector3d place = soup.positions.row(v);
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero(), normal = Eigen::RowVector3d::Zero();
    double length = 0.0;
    for (const int corner : around) {
      normal += normals.row(corner / 3);
      for (int k = 1; k < 3; ++k) {
        const Eigen::RowVector3d other = soup.positions.row(soup.triangles[corner / 3][(corner + k) % 3]);
        sum += other;
        length += (other - place).norm();
      }
    }
    const double count = 2.0 * static_cast<double>(around.size());
    const Eigen::RowVector3d offset = place - sum / count;
    const double norm = normal.norm();
    // A needle's normals cancel out: its whole offset counts then.
    result.height[v] = norm > 0.3 * 0.5 * count ? std::abs(offset.dot(normal) / norm) : offset.norm();
    result.edge[v] = length / count;
  });
  return result;
}

// A spike stands out from the scan's usual roughness and is steep as well, so that a coarse mesh's nose is none.
int drop_once(Soup& soup, double factor) {
  const Relief now = relief(soup, vertex_corners(soup));
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
