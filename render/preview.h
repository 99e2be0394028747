#pragma once

#include <optional>
#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "core/mesh.h"
#include "render/colour_map.h"

namespace vultus::render {

/// A scalar for each vertex shown in colours; `low` and `high` are the ends of the legend.
struct VertexField {
  std::vector<float> values;  ///< vertex_count; NaN shows grey
  double low = 0.0, high = 1.0;
  ColourMap map = ColourMap::sequential;
};

struct PreviewOptions {
  std::optional<VertexField> field;            ///< instead of the mesh's own colours
  Eigen::Vector3f colour{0.55f, 0.5f, 0.46f};  ///< linear, of a mesh without colours
  std::vector<int> hidden_vertices;            ///< triangles with all corners among these are left out
  double contrast = 0.75;                      ///< of the shading, 0 (flat colours) to 1
  int samples = 16;                            ///< a pixel, 1 to 256; each casts one ray for ambient occlusion
  std::optional<Eigen::Vector3f> background;   ///< linear; without it the picture has an alpha channel
};

/// A quick shaded still: light from above the camera and from all around, darker where the surface closes on itself
/// (ambient occlusion within 40 mm). For heat maps, region maps and contact sheets; 512² takes a third of a second on
/// two cores. Linear values that display as they are (no tone curve). Throws `InputError` when sizes disagree.
Image render_preview(const Mesh& mesh, const Camera& camera, const PreviewOptions& options = {});

}  // namespace vultus::render
