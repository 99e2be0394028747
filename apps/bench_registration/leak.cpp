#include "apps/bench_registration/leak.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "apps/bench_registration/statistics.h"
#include "core/error.h"
#include "core/neighbours.h"
#include "core/random.h"

namespace vultus::apps::bench {
namespace {

Points finite_rows(const Points& points) {
  Points kept(points.rows(), 3);
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    if (points.row(i).allFinite()) kept.row(count++) = points.row(i);
  kept.conservativeResize(count, 3);
  return kept;
}

// One random place in a triangle of each measured vertex.
Points places_beside(const Truth& truth, const Topology& refined, const std::vector<bool>& measured) {
  const Triangles& triangles = refined.triangles();
  std::vector<std::vector<int>> of_vertex(measured.size());
  for (int t = 0; t < triangles.rows(); ++t)
    for (int c = 0; c < 3; ++c) of_vertex[triangles(t, c)].push_back(t);
  Random random(1, 9);
  Points places(truth.vertices.rows(), 3);
  Eigen::Index count = 0;
  for (std::size_t v = 0; v < measured.size(); ++v) {
    if (!measured[v] || of_vertex[v].empty()) continue;
    const auto corner = triangles.row(of_vertex[v][random.below(static_cast<int>(of_vertex[v].size()))]);
    const double r = std::sqrt(random.uniform()), s = random.uniform();
    places.row(count++) = (1.0 - r) * truth.vertices.row(corner[0]) + r * (1.0 - s) * truth.vertices.row(corner[1]) +
                          r * s * truth.vertices.row(corner[2]);
  }
  places.conservativeResize(count, 3);
  return places;
}

std::vector<float> nearest_distances(const PointTree& tree, const Points& places) {
  std::vector<float> distances(static_cast<std::size_t>(places.rows()));
  tbb::parallel_for(std::size_t{0}, distances.size(), [&](std::size_t i) {
    distances[i] = static_cast<float>(tree.nearest(places.row(static_cast<Eigen::Index>(i)), 1).front().distance);
  });
  return distances;
}

}  // namespace

Leak leak(const Truth& truth, const Topology& refined, const std::vector<bool>& measured, const Points& scan) {
  const PointTree tree(finite_rows(scan));
  std::vector<int> vertices;
  for (std::size_t v = 0; v < measured.size(); ++v)
    if (measured[v]) vertices.push_back(static_cast<int>(v));
  const std::vector<float> to_vertices = nearest_distances(tree, truth.vertices(vertices, Eigen::all));
  const auto near = std::ranges::count_if(to_vertices, [](float distance) { return distance < 1.5F; });
  return {quantile(to_vertices, 0.5), quantile(nearest_distances(tree, places_beside(truth, refined, measured)), 0.5),
          static_cast<double>(near) / static_cast<double>(to_vertices.size())};
}

}  // namespace vultus::apps::bench
