#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "core/mesh.h"
#include "render/environment.h"

namespace vultus::render {

/// How a surface shines: the coat of `Bsdf` in a user's terms.
struct Finish {
  float roughness = 0.5f;  ///< perceptual, [0, 1]
  float ior = 1.4f;        ///< index of refraction of the coat, [1, 3]
  float specular = 1.0f;   ///< scale of its reflectance, [0, 1]; 0: no coat
};

/// Everything a picture needs. Both renderers read the same scene.
struct Scene {
  std::shared_ptr<const Topology> topology;
  Points positions;                                  ///< vertex_count×3, mm
  Points vertex_colours;                             ///< vertex_count×3 linear reflectance, or 0 rows
  Image albedo;                                      ///< linear reflectance in texture space; wins over vertex colours
  Eigen::Vector3f base_colour{0.60f, 0.42f, 0.34f};  ///< reflectance where there is neither
  std::vector<Finish> finishes{Finish{}};            ///< one a vertex, interpolated, or a single one for all
  std::vector<int> hidden_vertices;                  ///< triangles with all three corners among these are left out
  Camera camera;
  std::shared_ptr<const Environment> environment;
  std::optional<Eigen::Vector3f> backdrop;  ///< what the camera sees behind the mesh; without it the environment

  /// Throws `InputError` when sizes disagree, a value leaves its range, or an albedo map meets a mesh without UVs.
  void validate() const;
};

}  // namespace vultus::render
