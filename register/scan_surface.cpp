#include "register/scan_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/neighbours.h"
#include "register/calmed_normals.h"

namespace vultus::registration {
namespace {

// Mean edge of the scan's triangles were they all alike, mm.
double spacing_of(const Mesh& scan) {
  const Triangles& triangles = scan.topology->triangles();
  double area = 0.0;
  for (int t = 0; t < triangles.rows(); ++t) {
    const Eigen::Vector3d a = scan.positions.row(triangles(t, 0)), b = scan.positions.row(triangles(t, 1)),
                          c = scan.positions.row(triangles(t, 2));
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  return std::sqrt(4.0 / std::sqrt(3.0) * area / std::max<double>(1.0, static_cast<double>(triangles.rows())));
}

// Rounds that average normals over about a millimetre, however dense the scan is: 0.1 mm of noise turns those of
// half-millimetre triangles by tens of degrees, and a fit drawn along them creeps over the surface.
int calming_rounds(const Mesh& scan) {
  constexpr double reach = 1.0;  // mm
  const double rounds = 2.0 * std::pow(reach / std::max(1e-3, spacing_of(scan)), 2);
  return std::clamp(static_cast<int>(std::lround(rounds)), 1, 20);
}

}  // namespace

ScanSurface::ScanSurface(const Mesh& scan, std::vector<bool> invented)
    : scan_(&scan),
      rays_(*scan.topology, scan.positions),
      normals_(calmed_normals(scan, calming_rounds(scan))),
      border_(border_vertices(*scan.topology)),
      invented_(std::move(invented)) {
  if (invented_.empty()) return;
  const Triangles& triangles = scan.topology->triangles();
  if (invented_.size() != static_cast<std::size_t>(triangles.rows()))
    throw InputError("scan surface: one flag for each triangle is needed");
  invented_vertex_.assign(scan.topology->vertex_count(), true);
  for (int t = 0; t < triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k)
      if (!invented_[t]) invented_vertex_[triangles(t, k)] = false;
}

bool ScanSurface::on_border(const SurfacePoint& place) const {
  const auto corners = scan_->topology->triangles().row(place.triangle);
  int on = 0;
  for (int k = 0; k < 3; ++k) {
    if (place.barycentric[k] < 1e-4) continue;
    if (!border_[corners[k]]) return false;
    ++on;
  }
  return on < 3;  // well inside a triangle is no border, even if all its corners are
}

Eigen::Vector3d ScanSurface::normal_at(const SurfacePoint& place) const {
  return position_of(place, *scan_->topology, normals_).normalized();
}

std::optional<Correspondence> ScanSurface::nearest(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                                                   double limit, double least_cosine) const {
  const auto found = rays_.closest(point, limit);
  if (!found || !is_data(found->place) || on_border(found->place)) return {};
  const Eigen::Vector3d scan_normal = normal_at(found->place);
  if (scan_normal.dot(normal) < least_cosine) return {};
  return Correspondence{found->position, scan_normal, found->distance};
}

std::optional<Correspondence> ScanSurface::along(const Eigen::Vector3d& point, const Eigen::Vector3d& direction,
                                                 const Eigen::Vector3d& normal, double limit,
                                                 double least_cosine) const {
  std::optional<Correspondence> best;
  const Eigen::Vector3d start = point - limit * direction;
  double from = 0.0;
  while (from < 2.0 * limit) {
    const auto hit = rays_.hit(start, direction, from, 2.0 * limit);
    if (!hit) break;
    from = hit->distance + 1e-3;
    const double distance = std::abs(hit->distance - limit);
    if (best && distance >= best->distance) break;  // hits come in order: they only move away now
    const Eigen::Vector3d scan_normal = normal_at(hit->place);
    if (!is_data(hit->place) || scan_normal.dot(normal) < least_cosine) continue;
    best = Correspondence{start + hit->distance * direction, scan_normal, distance};
  }
  return best;
}

}  // namespace vultus::registration
