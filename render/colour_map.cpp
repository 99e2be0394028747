#include "render/colour_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vultus::render {
namespace {

/// Oklab lightness, chroma and hue (degrees) to linear sRGB (Ottosson 2020).
Eigen::Vector3d from_oklch(double lightness, double chroma, double hue) {
  const double a = chroma * std::cos(hue * std::numbers::pi / 180), b = chroma * std::sin(hue * std::numbers::pi / 180);
  const double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3);
  const double m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3);
  const double s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

/// The most saturated displayable colour of that lightness and hue, up to `chroma`.
Eigen::Vector3f displayable(double lightness, double chroma, double hue) {
  const auto fits = [](const Eigen::Vector3d& c) { return c.minCoeff() >= 0.0 && c.maxCoeff() <= 1.0; };
  while (chroma > 0.0 && !fits(from_oklch(lightness, chroma, hue))) chroma -= 0.002;
  return from_oklch(lightness, std::max(chroma, 0.0), hue).cwiseMax(0.0).cwiseMin(1.0).cast<float>();
}

}  // namespace

Eigen::Vector3f mapped_colour(ColourMap map, double t) {
  if (std::isnan(t)) return Eigen::Vector3f::Constant(0.18f);
  t = std::clamp(t, 0.0, 1.0);
  if (map == ColourMap::sequential) return displayable(0.95 - 0.67 * t, 0.02 + 0.32 * std::min(t, 0.5), 105 - 160 * t);
  const double away = std::abs(2.0 * t - 1.0);
  return displayable(0.96 - 0.48 * away, 0.21 * away, t < 0.5 ? 255.0 : 27.0);
}

std::vector<Eigen::Vector3f> distinct_colours(int count) {
  std::vector<Eigen::Vector3f> colours;
  // Steps of the golden angle keep neighbours in the list far apart for any count; lightness alternates for more.
  for (int i = 0; i < count; ++i)
    colours.push_back(displayable(0.74 - 0.11 * (i % 3 == 1) + 0.07 * (i % 3 == 2), 0.16, 25.0 + 137.50776 * i));
  return colours;
}

Image colour_bar(ColourMap map, int width, int height) {
  Image bar = Image::rgb(width, height);
  for (int x = 0; x < width; ++x) {
    const Eigen::Vector3f colour = mapped_colour(map, (x + 0.5) / width);
    for (int y = 0; y < height; ++y) bar.set_rgb(x, y, colour);
  }
  return bar;
}

}  // namespace vultus::render
