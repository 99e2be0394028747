#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/image.h"

namespace vultus::render {

/// Light from all around, infinitely far away: a latitude-longitude radiance map. Rows run from +y (top) to -y; the
/// centre of the map lies along -z, which is what a camera in front of the face looks at, +x to its right. Radiance is
/// bilinear between texel centres; directions are drawn from a piecewise-constant density in proportion to its
/// luminance times sin θ (Pharr, Jakob, Humphreys 2016, §14.2.4).
class Environment {
 public:
  /// `latlong` has 1 or 3 and more channels, the first three linear RGB; negative values count as 0. `rotation` turns
  /// the light about +y (radians, counter-clockwise seen from above); `intensity` ≥ 0 multiplies it.
  explicit Environment(Image latlong, double rotation = 0.0, double intensity = 1.0);

  static Environment load(const std::filesystem::path& file, double rotation = 0.0, double intensity = 1.0);
  static Environment constant(const Eigen::Vector3f& radiance);
  /// Our portrait studio: a soft key from the camera's left, a wide fill, two rim strips behind, a dim ground.
  static Environment studio(double rotation = 0.0, double intensity = 1.0);

  Eigen::Vector3f radiance(const Eigen::Vector3f& direction) const;  ///< unit direction, world

  struct Sample {
    Eigen::Vector3f direction;  ///< unit, world
    Eigen::Vector3f radiance;
    float pdf = 0.0f;  ///< per steradian; 0 when the map is black
  };
  Sample sample(const Eigen::Vector2f& u) const;
  float pdf(const Eigen::Vector3f& direction) const;  ///< per steradian

 private:
  Eigen::Vector2f map_coordinates(const Eigen::Vector3f& direction) const;
  Eigen::Vector3f texel(int x, int y) const;  ///< -1 ≤ x ≤ width wraps round, y is clamped
  Eigen::Vector3f at(const Eigen::Vector2f& uv) const;
  void build_density();

  int width_ = 0, height_ = 0;
  std::vector<Eigen::Vector3f> texels_;
  std::vector<float> row_cdf_;                           // height+1
  std::vector<float> column_cdf_;                        // height × (width+1)
  std::vector<std::uint16_t> row_guide_, column_guide_;  // where searches in those start
  std::vector<float> density_;                           // height × width, over the unit square; mean 1
  float rotation_ = 0.0f;
};

}  // namespace vultus::render
