#include "register/appearance.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/image.h"

namespace vultus::registration {
namespace {

// Mean curvature of a crease that counts fully, 1/mm.
constexpr double strong_curvature = 0.08;

// Mean curvature by the turn of the smoothed normals along the edges, averaged over a vertex.
Eigen::VectorXf relief_of(const Mesh& scan, const Points& normals) {
  const Triangles& triangles = scan.topology->triangles();
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(scan.positions.rows()), count = sum;
  for (int t = 0; t < triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = triangles(t, k), b = triangles(t, (k + 1) % 3);
      const Eigen::RowVector3d edge = scan.positions.row(b) - scan.positions.row(a);
      const double curvature = (normals.row(b) - normals.row(a)).dot(edge) / std::max(1e-6, edge.squaredNorm());
      for (int v : {a, b}) {
        sum[v] += curvature;
        count[v] += 1.0;
      }
    }
  Eigen::VectorXf relief(sum.size());
  for (int v = 0; v < relief.size(); ++v)
    relief[v] = static_cast<float>(std::tanh(sum[v] / std::max(1.0, count[v]) / strong_curvature));
  return relief;
}

}  // namespace

Appearance::Appearance(Mesh scan)
    : scan_(std::move(scan)), pictures_(scan_), relief_(relief_of(scan_, pictures_.normals())) {}

Eigen::Vector3d Appearance::position(const SurfacePoint& place) const {
  return position_of(place, *scan_.topology, scan_.positions);
}

float Appearance::colour(const SurfacePoint& place) const {
  return srgb_from_linear(static_cast<float>(std::clamp(pictures_.albedo(place), 0.0, 1.0)));
}

float Appearance::relief(const SurfacePoint& place) const {
  const auto corners = scan_.topology->triangles().row(place.triangle);
  float value = 0.0f;
  for (int k = 0; k < 3; ++k) value += static_cast<float>(place.barycentric[k]) * relief_[corners[k]];
  return value;
}

}  // namespace vultus::registration
