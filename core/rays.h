#pragma once

#include <memory>
#include <optional>

#include "core/mesh.h"

namespace vultus {

struct RayHit {
  SurfacePoint place;
  double distance = 0.0;  ///< along the unit direction, mm
};

struct ClosestPoint {
  SurfacePoint place;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double distance = 0.0;  ///< mm
};

/// Rays and closest points on a triangle mesh (Embree). Queries are const and may run from many threads.
class RayScene {
 public:
  RayScene(const Topology& topology, const Points& positions);
  ~RayScene();
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;

  /// First hit with distance in (min_distance, max_distance); `direction` need not be unit (distance is then in mm
  /// all the same).
  std::optional<RayHit> hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double min_distance = 0.0,
                            double max_distance = 1e30) const;
  bool occluded(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double min_distance,
                double max_distance) const;
  /// Nearest point of the surface within `max_distance`.
  std::optional<ClosestPoint> closest(const Eigen::Vector3d& point, double max_distance = 1e30) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vultus
