#include "render/film.h"

#include <algorithm>
#include <cmath>

namespace vultus::render {

Image make_layers(int width, int height) {
  return Image(
      width, height,
      {"R", "G", "B", "coverage", "albedo.R", "albedo.G", "albedo.B", "normal.X", "normal.Y", "normal.Z", "depth.Z"});
}

void PixelSum::add(const PathSample& sample) {
  ++count_;
  radiance_ += sample.radiance.cast<double>();
  const double luminance = sample.radiance.cast<double>().dot(Eigen::Vector3d(0.2126, 0.7152, 0.0722));
  luminance_ += luminance;
  squares_ += luminance * luminance;
  if (!sample.covered) return;
  ++covered_;
  albedo_ += sample.albedo.cast<double>();
  normal_ += sample.normal.cast<double>();
  depth_ += sample.depth;
}

double PixelSum::squared_error() const {
  if (count_ < 2) return 0.0;
  const double mean = luminance_ / count_;
  return std::max(0.0, squares_ / count_ - mean * mean) / (count_ - 1);
}

void PixelSum::store(float* p) const {
  if (count_ == 0) return;
  const Eigen::Vector3f radiance = (radiance_ / count_).cast<float>(), albedo = (albedo_ / count_).cast<float>();
  const Eigen::Vector3f normal = normal_.normalized().cast<float>();
  std::copy_n(radiance.data(), 3, p);
  p[3] = static_cast<float>(covered_) / static_cast<float>(count_);
  std::copy_n(albedo.data(), 3, p + 4);
  std::copy_n(normal.data(), 3, p + 7);
  p[10] = covered_ > 0 ? static_cast<float>(depth_ / covered_) : 0.0f;
}

Image developed(const Image& layers, ToneCurve curve, double exposure) {
  const float gain = static_cast<float>(std::exp2(exposure));
  const auto curved = [&](float x) {
    x = std::max(0.0f, x * gain);
    if (curve == ToneCurve::srgb || x <= 0.5f) return std::min(x, 1.0f);
    return 1.0f - 0.5f * std::exp(-(x - 0.5f) / 0.5f);
  };
  Image result = Image::rgb(layers.width(), layers.height());
  for (int y = 0; y < layers.height(); ++y)
    for (int x = 0; x < layers.width(); ++x) {
      const Eigen::Vector3f c = layers.rgb_at(x, y);
      result.set_rgb(x, y, {curved(c[0]), curved(c[1]), curved(c[2])});
    }
  return result;
}

void write_frame(const std::filesystem::path& file, const Image& layers, ToneCurve curve, double exposure) {
  std::filesystem::path picture = file;
  write_image(picture.replace_extension(".png"), developed(layers, curve, exposure));
  write_image(file, layers);
}

}  // namespace vultus::render
