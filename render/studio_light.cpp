#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/environment.h"

namespace vultus::render {
namespace {

constexpr float degree = std::numbers::pi_v<float> / 180.0f;

float smooth_step(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

/// A rectangular soft box that faces the head: azimuth from +z towards +x, elevation above the horizon, half sizes as
/// seen from the head, all in degrees. Brightest in its middle, as a lamp behind a diffuser is.
struct SoftBox {
  float azimuth, elevation, half_width, half_height;
  Eigen::Vector3f radiance;

  Eigen::Vector3f towards(const Eigen::Vector3f& direction) const {
    const float a = azimuth * degree, e = elevation * degree;
    const Eigen::Vector3f axis(std::sin(a) * std::cos(e), std::sin(e), std::cos(a) * std::cos(e));
    const float along = direction.dot(axis);
    if (along <= 0.0f) return Eigen::Vector3f::Zero();
    const Eigen::Vector3f right = Eigen::Vector3f::UnitY().cross(axis).normalized(), up = axis.cross(right);
    const float x = std::abs(direction.dot(right) / along) / std::tan(half_width * degree);
    const float y = std::abs(direction.dot(up) / along) / std::tan(half_height * degree);
    const float inside = (1.0f - smooth_step(0.9f, 1.1f, x)) * (1.0f - smooth_step(0.9f, 1.1f, y));
    return radiance * inside * (1.0f - 0.35f * std::min(1.0f, 0.5f * (x * x + y * y)));
  }
};

const SoftBox boxes[] = {
    {-42.0f, 34.0f, 24.0f, 26.0f, {7.4f, 6.95f, 6.35f}},  // key, camera left
    {58.0f, 8.0f, 34.0f, 36.0f, {0.62f, 0.67f, 0.76f}},   // fill, camera right
    {142.0f, 24.0f, 9.0f, 34.0f, {6.2f, 6.6f, 7.3f}},     // rim strips behind
    {-150.0f, 30.0f, 7.0f, 30.0f, {4.2f, 4.35f, 4.6f}},
};

Eigen::Vector3f studio_radiance(const Eigen::Vector3f& direction) {
  const Eigen::Vector3f ground(0.045f, 0.04f, 0.036f), wall(0.075f, 0.08f, 0.088f), ceiling(0.24f, 0.255f, 0.285f);
  const float up = direction.y();
  Eigen::Vector3f result = up < 0.0f ? Eigen::Vector3f(wall + (ground - wall) * smooth_step(0.0f, 0.35f, -up))
                                     : Eigen::Vector3f(wall + (ceiling - wall) * smooth_step(0.0f, 1.0f, up));
  for (const SoftBox& box : boxes) result += box.towards(direction);
  return result;
}

}  // namespace

Environment Environment::studio(double rotation, double intensity) {
  constexpr int width = 256, height = 128;  // small enough to stay in the cache
  Image image = Image::rgb(width, height);
  for (int y = 0; y < height; ++y) {
    const float theta = std::numbers::pi_v<float> * (static_cast<float>(y) + 0.5f) / height;
    for (int x = 0; x < width; ++x) {
      const float phi = 2 * std::numbers::pi_v<float> * ((static_cast<float>(x) + 0.5f) / width - 0.5f);
      image.set_rgb(
          x, y, studio_radiance({std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi)}));
    }
  }
  return Environment(std::move(image), rotation, intensity);
}

}  // namespace vultus::render
