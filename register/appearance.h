#pragma once

#include <Eigen/Core>

#include "register/shaded_view.h"

namespace vultus::registration {

/// What tells one place of a scanned skin from the next whatever the light: colour where the scan has any, and relief,
/// the mean curvature of the surface at a scale of some 2 mm.
class Appearance {
 public:
  explicit Appearance(Mesh scan);
  Appearance(const Appearance&) = delete;  // pictures refer to the scan beside them

  bool coloured() const { return pictures_.coloured(); }
  const RayScene& rays() const { return pictures_.rays(); }
  Eigen::Vector3d position(const SurfacePoint& place) const;
  Eigen::Vector3d normal(const SurfacePoint& place) const { return pictures_.normal(place); }
  float colour(const SurfacePoint& place) const;  ///< encoded luminance, [0, 1]
  float relief(const SurfacePoint& place) const;  ///< (−1, 1), positive on ridges

 private:
  Mesh scan_;
  ScanPictures pictures_;
  Eigen::VectorXf relief_;  // vertex_count
};

}  // namespace vultus::registration
