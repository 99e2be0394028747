#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>

#include "render/scene.h"

namespace vultus::render {

struct Ray {
  Eigen::Vector3f origin, direction;  ///< scene space (see `TracedScene`), unit
};

/// What a ray found.
struct Crossing {
  int triangle = -1;
  float u = 0, v = 0;  ///< barycentric weights of the second and third corner
  float distance = 0;  ///< mm
};

/// The surface at a crossing, seen from the ray's side.
struct Surface {
  Eigen::Vector3f position;          ///< scene space
  Eigen::Vector3f lifted;            ///< where rays that leave start: on the smooth surface the shading normals suggest
  Eigen::Vector3f geometric_normal;  ///< unit, on the ray's side
  Eigen::Vector3f shading_normal;    ///< unit, interpolated, turned so that the ray sees it
  Eigen::Vector3f albedo;            ///< [0, 1]
  Finish finish;
};

/// A scene made ready for Embree: single precision about the mesh's centre (scene space = world − `centre`).
class TracedScene {
 public:
  explicit TracedScene(const Scene& scene);  ///< keeps a reference to `scene`
  ~TracedScene();
  TracedScene(const TracedScene&) = delete;
  TracedScene& operator=(const TracedScene&) = delete;

  const Eigen::Vector3d& centre() const;
  bool intersect(const Ray& ray, Crossing& crossing) const;
  bool occluded(const Ray& ray, float max_distance = std::numeric_limits<float>::infinity()) const;
  Surface surface(const Ray& ray, const Crossing& crossing) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vultus::render
