#pragma once

#include <span>
#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "core/mesh.h"
#include "core/rays.h"
#include "register/face_finder.h"

namespace vultus::registration {

/// A scan made ready for being looked at: rays, normals smoothed over the scanner's noise, colours where it has any.
class ScanPictures {
 public:
  /// Uses vertex colours, else the image that `scan.texture` names where it can be read, else a grey skin.
  explicit ScanPictures(const Mesh& scan);

  bool coloured() const { return scan_->has_colours() || !texture_.empty(); }
  const RayScene& rays() const { return rays_; }
  const Mesh& scan() const { return *scan_; }

  /// Grey sRGB pictures by one camera, one for each distant light; `lights` are directions towards the light, camera
  /// axes (x right, y down, z forward).
  std::vector<GreyImage> shade(const Camera& camera, std::span<const Eigen::Vector3d> lights) const;

  /// Unit normal (smoothed) at a place.
  Eigen::Vector3d normal(const SurfacePoint& place) const;
  const Points& normals() const { return normals_; }  ///< the same at the scan's vertices
  /// Linear luminance of the colour at a place.
  double albedo(const SurfacePoint& place) const;

 private:
  const Mesh* scan_;
  RayScene rays_;
  Points normals_;  // vertex_count×3
  Image texture_;
};

}  // namespace vultus::registration
