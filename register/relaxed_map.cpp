#include "register/relaxed_map.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace vultus::registration::layout {
namespace {

using Matrix2 = Eigen::Matrix2d;

struct Element {
  std::array<int, 3> corner;
  Matrix2 rest_inverse;  ///< of the edges ab, ac laid flat
  double area;           ///< weight in the energy
};

double area_of(const Uvs& uv, const std::array<int, 3>& t) {
  const Eigen::Vector2d s = (uv.row(t[1]) - uv.row(t[0])).transpose(), r = (uv.row(t[2]) - uv.row(t[0])).transpose();
  return 0.5 * (s.x() * r.y() - s.y() * r.x());
}

Matrix2 laid_flat(const Eigen::Vector3d& ab, const Eigen::Vector3d& ac) {
  Matrix2 edges;
  const double length = ab.norm();
  edges << length, ab.dot(ac) / length, 0.0, ab.cross(ac).norm() / length;
  return edges;
}

/// Triangles of the disc, scaled to the chart's area, and light ones that keep holes open.
std::vector<Element> elements(const Disc& disc, const Uvs& uv) {
  std::vector<Element> all;
  double rest_area = 0.0, chart_area = 0.0;
  for (std::size_t t = 0; t < disc.triangles.size(); ++t) {
    const auto& [a, b, c] = disc.triangles[t];
    const Matrix2 flat = disc.importance[t] * laid_flat(disc.positions.row(b) - disc.positions.row(a),
                                                        disc.positions.row(c) - disc.positions.row(a));
    all.push_back({disc.triangles[t], flat, 0.5 * flat.determinant()});
    rest_area += all.back().area;
    chart_area += area_of(uv, disc.triangles[t]);
  }
  const double scale = std::sqrt(chart_area / rest_area);
  for (Element& e : all) {
    e.rest_inverse = (scale * e.rest_inverse).inverse().eval();
    e.area /= rest_area;
  }
  const int n = static_cast<int>(disc.positions.rows());
  for (int h = 0; h < static_cast<int>(disc.holes.size()); ++h) {
    const auto& ring = disc.holes[h];
    for (std::size_t i = 0; i < ring.size(); ++i) {
      std::array<int, 3> corner = {ring[i], ring[(i + 1) % ring.size()], n + h};
      if (area_of(uv, corner) < 0.0) std::swap(corner[0], corner[1]);
      Matrix2 rest;
      const double side = scale * (disc.positions.row(corner[0]) - disc.positions.row(corner[1])).norm();
      rest << side, 0.5 * side, 0.0, side * static_cast<double>(ring.size()) / (2.0 * M_PI);
      all.push_back({corner, rest.inverse(), 1e-4});
    }
  }
  return all;
}

Matrix2 jacobian(const Element& e, const Uvs& uv) {
  Matrix2 edges;
  edges.col(0) = (uv.row(e.corner[1]) - uv.row(e.corner[0])).transpose();
  edges.col(1) = (uv.row(e.corner[2]) - uv.row(e.corner[0])).transpose();
  return edges * e.rest_inverse;
}

double energy(const std::vector<Element>& all, const Uvs& uv) {
  double sum = 0.0;
  for (const Element& e : all) {
    const Matrix2 j = jacobian(e, uv);
    const double d = j.determinant();
    if (d <= 0.0) return std::numeric_limits<double>::infinity();
    sum += e.area * j.squaredNorm() * (1.0 + 1.0 / (d * d));
  }
  return sum;
}

Uvs gradient(const std::vector<Element>& all, const Uvs& uv, const std::vector<bool>& fixed) {
  Uvs g = Uvs::Zero(uv.rows(), 2);
  for (const Element& e : all) {
    const Matrix2 j = jacobian(e, uv);
    const double d = j.determinant();
    Matrix2 cofactor;
    cofactor << j(1, 1), -j(1, 0), -j(0, 1), j(0, 0);
    const Matrix2 by_jacobian = 2.0 * e.area * ((1.0 + 1.0 / (d * d)) * j - j.squaredNorm() / (d * d * d) * cofactor);
    const Matrix2 by_edges = by_jacobian * e.rest_inverse.transpose();
    g.row(e.corner[1]) += by_edges.col(0).transpose();
    g.row(e.corner[2]) += by_edges.col(1).transpose();
    g.row(e.corner[0]) -= (by_edges.col(0) + by_edges.col(1)).transpose();
  }
  for (int v = 0; v < g.rows(); ++v)
    if (fixed[v]) g.row(v).setZero();
  return g;
}

Eigen::SparseMatrix<double> laplacian(const std::vector<Element>& all, int n, const std::vector<bool>& fixed) {
  std::vector<Eigen::Triplet<double>> entries;
  for (const Element& e : all)
    for (int k = 0; k < 3; ++k) {
      const int a = e.corner[k], b = e.corner[(k + 1) % 3];
      if (!fixed[a]) entries.emplace_back(a, a, 1.0);
      if (!fixed[b]) entries.emplace_back(b, b, 1.0);
      if (fixed[a] || fixed[b]) continue;
      entries.emplace_back(a, b, -1.0);
      entries.emplace_back(b, a, -1.0);
    }
  for (int v = 0; v < n; ++v)
    if (fixed[v]) entries.emplace_back(v, v, 1.0);
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// The start with each hole's virtual vertex at its ring's mean.
Uvs with_hole_centres(const Disc& disc, const Uvs& uv) {
  const int n = static_cast<int>(uv.rows());
  Uvs all(n + static_cast<int>(disc.holes.size()), 2);
  all.topRows(n) = uv;
  for (std::size_t h = 0; h < disc.holes.size(); ++h) {
    Eigen::RowVector2d mean = Eigen::RowVector2d::Zero();
    for (const int v : disc.holes[h]) mean += uv.row(v) / static_cast<double>(disc.holes[h].size());
    all.row(n + static_cast<int>(h)) = mean;
  }
  return all;
}

}  // namespace

Uvs relaxed_map(const Disc& disc, const Uvs& start, int steps) {
  Uvs uv = with_hole_centres(disc, start);
  const std::vector<Element> all = elements(disc, uv);
  const int n = static_cast<int>(uv.rows());
  std::vector<bool> fixed(n, false);
  for (const int v : disc.outline) fixed[v] = true;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(laplacian(all, n, fixed));
  double now = energy(all, uv), step = 1.0;
  Uvs direction = Uvs::Zero(n, 2), before = Uvs::Zero(n, 2);
  double before_norm = 0.0;
  for (int i = 0; i < steps && std::isfinite(now); ++i) {
    const Uvs g = gradient(all, uv, fixed);
    const Uvs smooth = solver.solve(Eigen::MatrixXd(g));
    const double norm = g.cwiseProduct(smooth).sum();
    const double beta =
        before_norm == 0.0 ? 0.0 : std::max(0.0, (norm - before.cwiseProduct(smooth).sum()) / before_norm);
    direction = beta * direction - smooth;
    double slope = direction.cwiseProduct(g).sum();
    if (slope >= 0.0) {
      direction = -smooth;
      slope = -norm;
    }
    step *= 4.0;
    double next = energy(all, uv + step * direction);
    while (!(next <= now + 1e-4 * step * slope) && step > 1e-12) next = energy(all, uv + (step *= 0.5) * direction);
    if (!(next < now)) {
      if (beta == 0.0) break;
      before_norm = 0.0;  // once more, straight downhill
      step = 1.0;
      continue;
    }
    uv += step * direction;
    const bool settled = now - next < 1e-7 * now;
    now = next;
    before = g;
    before_norm = norm;
    if (settled && beta == 0.0) break;
    if (settled) before_norm = 0.0;
  }
  return uv.topRows(disc.positions.rows());
}

}  // namespace vultus::registration::layout
