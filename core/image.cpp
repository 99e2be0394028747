#include "core/image.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace vultus {

Image::Image(int width, int height, std::vector<std::string> channel_names)
    : width_(width), height_(height), channel_names_(std::move(channel_names)) {
  if (width <= 0 || height <= 0 || channel_names_.empty())
    throw InputError("image of " + std::to_string(width) + "x" + std::to_string(height) + " with " +
                     std::to_string(channel_names_.size()) + " channels; each must be at least 1");
  pixels_.assign(static_cast<std::size_t>(width) * height * channel_names_.size(), 0.0f);
}

Eigen::Vector3f Image::rgb_at(int x, int y) const {
  const float* p = at(x, y);
  if (channels() < 3) return {p[0], p[0], p[0]};
  return {p[0], p[1], p[2]};
}

void Image::set_rgb(int x, int y, const Eigen::Vector3f& value) {
  float* p = at(x, y);
  for (int c = 0; c < std::min(channels(), 3); ++c) p[c] = value[c];
}

float Image::sample(double x, double y, int channel) const {
  const double u = std::clamp(x - 0.5, 0.0, width_ - 1.0), v = std::clamp(y - 0.5, 0.0, height_ - 1.0);
  const int x0 = static_cast<int>(u), y0 = static_cast<int>(v);
  const int x1 = std::min(x0 + 1, width_ - 1), y1 = std::min(y0 + 1, height_ - 1);
  const float fx = static_cast<float>(u - x0), fy = static_cast<float>(v - y0);
  const float top = at(x0, y0)[channel] * (1 - fx) + at(x1, y0)[channel] * fx;
  const float bottom = at(x0, y1)[channel] * (1 - fx) + at(x1, y1)[channel] * fx;
  return top * (1 - fy) + bottom * fy;
}

float srgb_from_linear(float linear) {
  if (linear <= 0.0031308f) return 12.92f * linear;
  return 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

float linear_from_srgb(float encoded) {
  if (encoded <= 0.04045f) return encoded / 12.92f;
  return std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

}  // namespace vultus
