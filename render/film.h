#pragma once

#include <Eigen/Core>
#include <filesystem>

#include "core/image.h"

namespace vultus::render {

/// What one path brought to its pixel.
struct PathSample {
  Eigen::Vector3f radiance = Eigen::Vector3f::Zero();
  bool covered = false;  ///< the camera saw the mesh; the rest is then meaningful
  Eigen::Vector3f albedo = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< shading normal, world
  float depth = 0.0f;                                ///< along the optical axis, mm
};

/// Channels of a rendered frame: R, G, B (linear), coverage, albedo.{R,G,B}, normal.{X,Y,Z} (world, unit), depth.Z
/// (mm). Normal and depth are means over the covered part of the pixel and 0 where nothing was seen.
Image make_layers(int width, int height);

/// Running sums of one pixel.
class PixelSum {
 public:
  void add(const PathSample& sample);
  void store(float* layers_pixel) const;
  int samples() const { return count_; }
  /// Squared standard error of the mean luminance as if samples were independent: stratified ones err less.
  double squared_error() const;
  double luminance() const { return count_ > 0 ? luminance_ / count_ : 0.0; }

 private:
  Eigen::Vector3d radiance_ = Eigen::Vector3d::Zero(), albedo_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal_ = Eigen::Vector3d::Zero();
  double depth_ = 0.0, luminance_ = 0.0, squares_ = 0.0;
  int count_ = 0, covered_ = 0;
};

/// How linear light becomes a display picture.
enum class ToneCurve {
  srgb,    ///< clamped at 1
  filmic,  ///< straight to 0.5, then 1 - 0.5·exp(-(x - 0.5)/0.5): highlights roll off, skin keeps its values
};

/// R, G, B of `layers` times 2^`exposure` through the curve, in [0, 1], still linear: `write_image` adds the sRGB
/// encoding.
Image developed(const Image& layers, ToneCurve curve, double exposure = 0.0);

/// Writes `file` (.exr) with every layer and a developed .png beside it. Throws `OutputError`.
void write_frame(const std::filesystem::path& file, const Image& layers, ToneCurve curve, double exposure = 0.0);

}  // namespace vultus::render
