#include "render/environment.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"

namespace vultus::render {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

float luminance(const Eigen::Vector3f& c) { return 0.2126f * c[0] + 0.7152f * c[1] + 0.0722f * c[2]; }

/// Running sum of n values as a distribution function that ends at exactly 1; even where all are 0. Returns the sum.
double accumulate(const double* values, int n, float* cdf) {
  double total = 0.0;
  for (int i = 0; i < n; ++i) total += values[i];
  double running = 0.0;
  cdf[0] = 0.0f;
  for (int i = 0; i < n; ++i) {
    running += values[i];
    cdf[i + 1] = static_cast<float>(total > 0.0 ? running / total : (i + 1.0) / n);
  }
  cdf[n] = 1.0f;
  return total;
}

/// For each of n equal steps of u, the bin in which it begins: the search starts there (Chen and Asau 1974).
void fill_guide(const float* cdf, int n, std::uint16_t* guide) {
  int bin = 0;
  for (int i = 0; i < n; ++i) {
    while (bin + 1 < n && cdf[bin + 1] <= static_cast<float>(i) / static_cast<float>(n)) ++bin;
    guide[i] = static_cast<std::uint16_t>(bin);
  }
}

struct Draw {
  int index;
  float offset;  // [0, 1) within the bin
};

Draw draw(const float* cdf, const std::uint16_t* guide, int n, float u) {
  int index = guide[std::min(static_cast<int>(u * static_cast<float>(n)), n - 1)];
  while (index > 0 && cdf[index] > u) --index;  // only where u·n rounded up
  while (index + 1 < n && cdf[index + 1] <= u) ++index;
  const float width = cdf[index + 1] - cdf[index];
  return {index, width > 0.0f ? std::min((u - cdf[index]) / width, 0x1.fffffep-1f) : 0.5f};
}

}  // namespace

Environment::Environment(Image latlong, double rotation, double intensity)
    : width_(latlong.width()), height_(latlong.height()), rotation_(static_cast<float>(rotation)) {
  if (latlong.empty()) throw InputError("environment: the image is empty");
  if (width_ > 65536 || height_ > 65536) throw InputError("environment: the image is larger than 65536 on a side");
  if (!(intensity >= 0.0) || !std::isfinite(intensity)) throw InputError("environment: intensity must be 0 or more");
  if (!std::isfinite(rotation)) throw InputError("environment: rotation must be finite");
  texels_.resize(static_cast<std::size_t>(width_) * height_);
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x)
      texels_[static_cast<std::size_t>(y) * width_ + x] =
          latlong.rgb_at(x, y).cwiseMax(0.0f) * static_cast<float>(intensity);
  build_density();
}

Environment Environment::load(const std::filesystem::path& file, double rotation, double intensity) {
  return Environment(read_image(file), rotation, intensity);
}

Environment Environment::constant(const Eigen::Vector3f& radiance) {
  Image image = Image::rgb(4, 8);
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) image.set_rgb(x, y, radiance);
  return Environment(std::move(image));
}

void Environment::build_density() {
  // Each texel's weight is the mean over the texels that bilinear look-ups in it reach, so that the density is
  // positive wherever the radiance is.
  std::vector<double> weights(texels_.size()), rows(height_);
  row_cdf_.resize(height_ + 1);
  row_guide_.resize(height_);
  column_cdf_.resize(static_cast<std::size_t>(height_) * (width_ + 1));
  column_guide_.resize(texels_.size());
  constexpr double tent[] = {0.125, 0.75, 0.125};
  for (int y = 0; y < height_; ++y) {
    const double sine = std::sin(std::numbers::pi * (y + 0.5) / height_);
    for (int x = 0; x < width_; ++x) {
      double mean = 0.0;
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) mean += tent[i + 1] * tent[j + 1] * luminance(texel(x + i, y + j));
      weights[static_cast<std::size_t>(y) * width_ + x] = mean * sine;
    }
    float* cdf = &column_cdf_[static_cast<std::size_t>(y) * (width_ + 1)];
    rows[y] = accumulate(&weights[static_cast<std::size_t>(y) * width_], width_, cdf);
    fill_guide(cdf, width_, &column_guide_[static_cast<std::size_t>(y) * width_]);
  }
  const double total = accumulate(rows.data(), height_, row_cdf_.data());
  fill_guide(row_cdf_.data(), height_, row_guide_.data());
  density_.resize(texels_.size());
  for (std::size_t i = 0; i < weights.size(); ++i)
    density_[i] = total > 0.0 ? static_cast<float>(weights[i] / total * static_cast<double>(weights.size())) : 0.0f;
}

Eigen::Vector3f Environment::texel(int x, int y) const {
  x = x < 0 ? x + width_ : x >= width_ ? x - width_ : x;
  y = std::clamp(y, 0, height_ - 1);
  return texels_[static_cast<std::size_t>(y) * width_ + x];
}

Eigen::Vector2f Environment::map_coordinates(const Eigen::Vector3f& direction) const {
  float u = 0.5f + (std::atan2(direction.x(), -direction.z()) + rotation_) / (2 * pi);
  u -= std::floor(u);
  const float v = std::acos(std::clamp(direction.y(), -1.0f, 1.0f)) / pi;
  return {std::min(u, 0x1.fffffep-1f), std::min(v, 0x1.fffffep-1f)};
}

Eigen::Vector3f Environment::at(const Eigen::Vector2f& uv) const {
  const float x = uv.x() * static_cast<float>(width_) - 0.5f, y = uv.y() * static_cast<float>(height_) - 0.5f;
  const float x0 = std::floor(x), y0 = std::floor(y), fx = x - x0, fy = y - y0;
  const int ix = static_cast<int>(x0), iy = static_cast<int>(y0);
  return (texel(ix, iy) * (1 - fx) + texel(ix + 1, iy) * fx) * (1 - fy) +
         (texel(ix, iy + 1) * (1 - fx) + texel(ix + 1, iy + 1) * fx) * fy;
}

Eigen::Vector3f Environment::radiance(const Eigen::Vector3f& direction) const { return at(map_coordinates(direction)); }

Environment::Sample Environment::sample(const Eigen::Vector2f& u) const {
  const Draw row = draw(row_cdf_.data(), row_guide_.data(), height_, u.y());
  const Draw column = draw(&column_cdf_[static_cast<std::size_t>(row.index) * (width_ + 1)],
                           &column_guide_[static_cast<std::size_t>(row.index) * width_], width_, u.x());
  const Eigen::Vector2f uv((static_cast<float>(column.index) + column.offset) / static_cast<float>(width_),
                           (static_cast<float>(row.index) + row.offset) / static_cast<float>(height_));
  const float theta = pi * uv.y(), phi = 2 * pi * (uv.x() - 0.5f) - rotation_;
  const float sine = std::sin(theta);
  Sample result;
  result.direction = {sine * std::sin(phi), std::cos(theta), -sine * std::cos(phi)};
  result.radiance = at(uv);
  const float density = density_[static_cast<std::size_t>(row.index) * width_ + column.index];
  result.pdf = sine > 0.0f ? density / (2 * pi * pi * sine) : 0.0f;
  return result;
}

float Environment::pdf(const Eigen::Vector3f& direction) const {
  const Eigen::Vector2f uv = map_coordinates(direction);
  const int x = static_cast<int>(uv.x() * static_cast<float>(width_));
  const int y = static_cast<int>(uv.y() * static_cast<float>(height_));
  const float sine = std::sqrt(std::max(0.0f, 1.0f - direction.y() * direction.y()));
  if (sine <= 0.0f) return 0.0f;
  return density_[static_cast<std::size_t>(std::min(y, height_ - 1)) * width_ + std::min(x, width_ - 1)] /
         (2 * pi * pi * sine);
}

}  // namespace vultus::render
