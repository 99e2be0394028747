#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "scan/soup.h"

namespace vultus::scan {
namespace {

// What the triangles around a vertex are like.
struct Surroundings {
  Points normal;                     // sum of area vectors
  Eigen::VectorXd area;              // sum of areas: the normal is as long where all of them look one way
  std::vector<float> sharp, corner;  // triangles that stand steep on their own corners' mean normal, and all
};

Surroundings at_vertices(const Soup& soup, const Corners& corners) {
  const int vertices = corners.vertex_count();
  Points areas(soup.triangles.size(), 3);
  tbb::parallel_for(Eigen::Index{0}, areas.rows(),
                    [&](Eigen::Index t) { areas.row(t) = area_vector(soup, static_cast<int>(t)); });
  Surroundings near{Points::Zero(vertices, 3), Eigen::VectorXd::Zero(vertices), {}, {}};
  Points directions(vertices, 3);
  tbb::parallel_for(0, vertices, [&](int v) {
    for (const int corner : corners.at(v)) {
      near.normal.row(v) += areas.row(corner / 3);
      near.area[v] += areas.row(corner / 3).norm();
    }
    directions.row(v) = near.normal.row(v).normalized();
  });
  constexpr double steep = 0.6;  // cosine of 53 degrees
  std::vector<char> sharp(soup.triangles.size());
  tbb::parallel_for(Eigen::Index{0}, areas.rows(), [&](Eigen::Index t) {
    Eigen::RowVector3d mean = Eigen::RowVector3d::Zero();
    for (const int v : soup.triangles[t]) mean += directions.row(v);
    sharp[t] = areas.row(t).dot(mean) < steep * areas.row(t).norm() * mean.norm();
  });
  near.sharp.assign(vertices, 0.0f);
  near.corner.assign(vertices, 0.0f);
  tbb::parallel_for(0, vertices, [&](int v) {
    for (const int corner : corners.at(v)) near.sharp[v] += sharp[corner / 3] ? 1.0f : 0.0f;
    near.corner[v] = static_cast<float>(corners.at(v).size());
  });
  return near;
}

// The same a ring farther out.
Surroundings widened(const Soup& soup, const Corners& corners, const Surroundings& near) {
  Surroundings wide = near;
  tbb::parallel_for(0, corners.vertex_count(), [&](int v) {
    for (const int corner : corners.at(v))
      for (int k = 1; k < 3; ++k) {
        const int other = soup.triangles[corner / 3][(corner + k) % 3];
        wide.normal.row(v) += near.normal.row(other);
        wide.area[v] += near.area[other];
        wide.sharp[v] += near.sharp[other];
        wide.corner[v] += near.corner[other];
      }
  });
  return wide;
}

double usual_edge(const Soup& soup) {
  std::vector<float> lengths;
  const std::size_t step = std::max<std::size_t>(1, soup.triangles.size() / 200'000);
  for (std::size_t t = 0; t < soup.triangles.size(); t += step) {
    const auto& c = soup.triangles[t];
    lengths.push_back(static_cast<float>((soup.positions.row(c[0]) - soup.positions.row(c[1])).norm()));
  }
  if (lengths.empty()) return 0.0;
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

// Vertices with nothing but edges longer than `limit`.
std::vector<bool> far_from_all(const Soup& soup, double limit) {
  std::vector<bool> far(soup.positions.rows(), true);
  for (const auto& c : soup.triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = c[k], b = c[(k + 1) % 3];
      if ((far[a] || far[b]) && (soup.positions.row(a) - soup.positions.row(b)).squaredNorm() <= limit * limit)
        far[a] = far[b] = false;
    }
  return far;
}

// Open edges among those that end at one of `vertices`.
std::vector<bool> on_border(const Soup& soup, const std::vector<bool>& vertices) {
  std::vector<std::pair<int, int>> edges;
  for (const auto& c : soup.triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = c[k], b = c[(k + 1) % 3];
      if (vertices[a] || vertices[b]) edges.emplace_back(std::min(a, b), std::max(a, b));
    }
  std::sort(edges.begin(), edges.end());
  std::vector<bool> border(vertices.size(), false);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if ((i > 0 && edges[i - 1] == edges[i]) || (i + 1 < edges.size() && edges[i + 1] == edges[i])) continue;
    border[edges[i].first] = border[edges[i].second] = true;
  }
  return border;
}

void drop_triangles_at(Soup& soup, const std::vector<bool>& vertices) {
  std::vector<bool> keep(soup.triangles.size());
  for (std::size_t t = 0; t < keep.size(); ++t) {
    const auto& c = soup.triangles[t];
    keep[t] = !vertices[c[0]] && !vertices[c[1]] && !vertices[c[2]];
  }
  keep_triangles(soup, keep);
}

}  // namespace

int drop_border_spikes(Soup& soup, double factor, int passes) {
  int dropped = 0;
  const double limit = factor * usual_edge(soup);
  for (int pass = 0; pass < passes; ++pass) {
    std::vector<bool> used(soup.positions.rows(), false), tip = far_from_all(soup, limit);
    for (const auto& c : soup.triangles)
      for (int v : c) used[v] = true;
    const std::vector<bool> border = on_border(soup, tip);
    int found = 0;
    for (std::size_t v = 0; v < tip.size(); ++v) {
      tip[v] = tip[v] && used[v] && border[v];
      found += tip[v];
    }
    if (found == 0) break;
    dropped += found;
    drop_triangles_at(soup, tip);
  }
  return dropped;
}

int drop_clutter(Soup& soup, double wildness) {
  const Corners corners = vertex_corners(soup);
  const Surroundings wide = widened(soup, corners, at_vertices(soup, corners));
  std::vector<bool> wild(soup.positions.rows());
  int found = 0;
  for (Eigen::Index v = 0; v < soup.positions.rows(); ++v) {
    if (wide.corner[v] == 0.0f) continue;
    const bool is_creased = wide.sharp[v] > wildness * wide.corner[v];
    wild[v] = is_creased && wide.normal.row(v).norm() < 0.75 * wide.area[v];
    found += wild[v];
  }
  // Much of it is no clutter but what the whole scan is like: noise finer than its sampling.
  if (found == 0 || found > 0.1 * static_cast<double>(soup.positions.rows())) return 0;
  drop_triangles_at(soup, wild);
  return found;
}

}  // namespace vultus::scan
