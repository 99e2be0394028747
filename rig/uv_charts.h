#pragma once

#include <vector>

#include "core/mesh.h"
#include "core/texture_space.h"

namespace vultus::rig {

/// Connected parts of the UV layout.
struct UvCharts {
  std::vector<int> of_triangle;  ///< chart of each triangle of the triangulated view
  int count = 0;
  std::vector<double> mm_per_texel;  ///< of each chart, from its area on the skin and in texels
};
UvCharts uv_charts(const TextureSpace& texels, const Points& positions);

/// Gaussian of `sigma_mm` over each chart of `image` by itself: Σ G·m / Σ G over the chart's texels. Values outside
/// charts are left as they are.
void smooth_in_charts(const TextureSpace& texels, const UvCharts& charts, double sigma_mm, Image& image);

/// Values at each UV row (uvs × channels), bilinear over the texels of the row's own chart; rows whose four texels are
/// all of other charts take the nearest texel of their own within two, else NaN.
Eigen::MatrixXf sample_at_uvs(const TextureSpace& texels, const UvCharts& charts, const Image& image);

}  // namespace vultus::rig
