#include "apps/virtual_stage/complexion.h"

#include <algorithm>
#include <array>

#include "core/random.h"

namespace vultus::virtual_stage {
namespace {

using Colour = Eigen::Vector3f;

/// Reflectance of skin from light to dark, about evenly spaced in melanin (after Krishnaswamy and Baranoski 2004).
const std::array<Colour, 5> skin_tones = {Colour(0.56f, 0.36f, 0.28f), Colour(0.49f, 0.29f, 0.21f),
                                          Colour(0.40f, 0.23f, 0.15f), Colour(0.27f, 0.145f, 0.09f),
                                          Colour(0.15f, 0.08f, 0.052f)};
const std::array<Colour, 4> hair_tones = {Colour(0.20f, 0.13f, 0.065f), Colour(0.085f, 0.048f, 0.026f),
                                          Colour(0.035f, 0.021f, 0.014f), Colour(0.012f, 0.010f, 0.009f)};
const std::array<Colour, 4> iris_tones = {Colour(0.10f, 0.17f, 0.26f), Colour(0.10f, 0.13f, 0.07f),
                                          Colour(0.11f, 0.06f, 0.025f), Colour(0.045f, 0.022f, 0.011f)};

template <std::size_t N>
Colour along(const std::array<Colour, N>& tones, double t) {
  const double x = std::clamp(t, 0.0, 1.0) * (N - 1);
  const std::size_t i = std::min<std::size_t>(static_cast<std::size_t>(x), N - 2);
  const auto f = static_cast<float>(x - static_cast<double>(i));
  return (1.0f - f) * tones[i] + f * tones[i + 1];
}

}  // namespace

Complexion random_complexion(std::uint64_t seed) {
  Random random(seed, 202);
  Complexion c;
  const double melanin = random.uniform(), light = 1.0 - melanin;
  c.skin = along(skin_tones, 0.9 * melanin);
  c.flush = c.skin.cwiseProduct(Colour(0.98f, 0.72f, 0.70f));
  c.lips = c.skin.cwiseProduct(Colour(0.86f, 0.54f, 0.58f));
  c.hair = along(hair_tones, std::clamp(melanin * 1.1 + random.uniform(-0.25, 0.35), 0.0, 1.0));
  c.iris = along(iris_tones, std::clamp(melanin * 1.5 + random.uniform(-0.3, 0.4), 0.0, 1.0));
  c.freckles = light * random.uniform() * 0.8;
  c.seed = random.next();
  return c;
}

}  // namespace vultus::virtual_stage
