#include "register/convex_map.h"

#include <Eigen/Geometry>
#include <Eigen/SparseLU>
#include <cmath>
#include <map>

namespace vultus::registration::layout {
namespace {

using Weights = std::vector<std::map<int, double>>;

/// Half of the angle's tangent at corner a of triangle abc, of the mean value coordinates.
double half_tangent(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d u = (b - a).normalized(), v = (c - a).normalized();
  return u.cross(v).norm() / (1.0 + u.dot(v));
}

/// Mean value weights (Floater 2003), positive on any mesh; a hole's virtual vertex counts as much as a mean neighbour.
Weights mean_value_weights(const Disc& disc) {
  const int n = static_cast<int>(disc.positions.rows()), holes = static_cast<int>(disc.holes.size());
  Weights weights(n + holes);
  for (const auto& t : disc.triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
      const Eigen::Vector3d p = disc.positions.row(a), q = disc.positions.row(b), r = disc.positions.row(c);
      const double tangent = half_tangent(p, q, r);
      weights[a][b] += tangent / (q - p).norm();
      weights[a][c] += tangent / (r - p).norm();
    }
  for (int h = 0; h < holes; ++h)
    for (const int v : disc.holes[h]) {
      double mean = 0.0;
      for (const auto& [w, weight] : weights[v]) mean += weight / static_cast<double>(weights[v].size());
      weights[v][n + h] = mean;
      weights[n + h][v] = 1.0;
    }
  return weights;
}

Uvs solve(const Disc& disc, const Weights& weights) {
  const int n = static_cast<int>(weights.size());
  std::vector<bool> fixed(n, false);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(n, 2);
  for (std::size_t i = 0; i < disc.outline.size(); ++i) {
    fixed[disc.outline[i]] = true;
    right.row(disc.outline[i]) = disc.outline_uv.row(static_cast<int>(i));
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (int v = 0; v < n; ++v) {
    entries.emplace_back(v, v, 1.0);
    if (fixed[v]) continue;
    double sum = 0.0;
    for (const auto& [w, weight] : weights[v]) sum += weight;
    for (const auto& [w, weight] : weights[v]) entries.emplace_back(v, w, -weight / sum);
  }
  Eigen::SparseMatrix<double> system(n, n);
  system.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SparseLU<Eigen::SparseMatrix<double>> solver(system);
  const Eigen::MatrixXd uv = solver.solve(right);
  return uv;
}

/// Squared L2 stretch of a triangle's map from texture to space (Sander et al. 2001), times its importance squared.
double stretch(const Disc& disc, const Uvs& uv, int t) {
  const auto& [a, b, c] = disc.triangles[t];
  const Eigen::Vector2d s = (uv.row(b) - uv.row(a)).transpose(), r = (uv.row(c) - uv.row(a)).transpose();
  const Eigen::Vector3d p = (disc.positions.row(b) - disc.positions.row(a)).transpose();
  const Eigen::Vector3d q = (disc.positions.row(c) - disc.positions.row(a)).transpose();
  const double area = s.x() * r.y() - s.y() * r.x();
  const Eigen::Vector3d du = (p * r.y() - q * s.y()) / area, dv = (q * s.x() - p * r.x()) / area;
  return 0.5 * (du.squaredNorm() + dv.squaredNorm()) * std::pow(disc.importance[t], 2);
}

}  // namespace

Uvs convex_map(const Disc& disc, int rounds) {
  Weights weights = mean_value_weights(disc);
  Uvs uv = solve(disc, weights);
  const int n = static_cast<int>(disc.positions.rows());
  for (int round = 0; round < rounds; ++round) {
    std::vector<double> sum(n, 0.0), area(n, 0.0);
    for (int t = 0; t < static_cast<int>(disc.triangles.size()); ++t) {
      const auto& [a, b, c] = disc.triangles[t];
      const Eigen::Vector3d p = (disc.positions.row(b) - disc.positions.row(a)).transpose();
      const Eigen::Vector3d q = (disc.positions.row(c) - disc.positions.row(a)).transpose();
      const double size = p.cross(q).norm();
      for (const int v : disc.triangles[t]) {
        sum[v] += size * stretch(disc, uv, t);
        area[v] += size;
      }
    }
    // The scale of all stretches is free; divided by their mean it keeps the virtual vertices' weights in proportion.
    double mean = 0.0;
    for (int v = 0; v < n; ++v) mean += std::sqrt(sum[v] / area[v]) / n;
    for (auto& row : weights)
      for (auto& [w, weight] : row)
        if (w < n) weight /= std::sqrt(std::sqrt(sum[w] / area[w]) / mean);
    uv = solve(disc, weights);
  }
  return uv.topRows(n);
}

}  // namespace vultus::registration::layout
