#pragma once

#include <vector>

#include "core/image.h"
#include "core/mesh.h"

namespace vultus {

/// Texel ↔ surface for one topology and map size. Texel (x, y), row 0 at the top, has its centre at
/// uv = ((x+0.5)/width, 1-(y+0.5)/height).
class TextureSpace {
 public:
  /// Throws `InputError` when the topology has no UVs.
  TextureSpace(std::shared_ptr<const Topology> topology, int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }
  const Topology& topology() const { return *topology_; }
  /// Surface under the texel's centre; invalid outside every chart.
  const SurfacePoint& at(int x, int y) const { return texels_[static_cast<std::size_t>(y) * width_ + x]; }
  /// Texels whose centre lies in more than one UV triangle: 0 for a layout without overlaps.
  int overlapping_texels() const { return overlapping_; }

  /// Interpolates per-vertex values (vertex_count×c) to a c-channel image and grows them over a gutter of 1/64 of the
  /// shorter side (at least 4 texels).
  Image bake(const Eigen::MatrixXf& vertex_values, std::vector<std::string> channel_names) const;
  /// Grows valid texels outward into empty ones (`gutter` texels, nearest first).
  void dilate(Image& image, int gutter) const;
  /// uv of a place on the surface, in the chart of its triangle.
  Eigen::Vector2d uv(const SurfacePoint& place) const;
  /// Bilinear look-up of a map at a place on the surface.
  float sample(const Image& map, const SurfacePoint& place, int channel) const;
  /// uv of each vertex in the chart of one of its corners (vertex_count×2).
  Uvs vertex_uvs() const;

 private:
  std::shared_ptr<const Topology> topology_;
  int width_, height_, overlapping_ = 0;
  std::vector<SurfacePoint> texels_;
};

}  // namespace vultus
