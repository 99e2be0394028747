#include "render/coat_albedo.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/bsdf.h"

namespace vultus::render {
namespace {

// Nodes at μ = t² and α = s²: the albedo changes fastest at grazing angles and for narrow lobes.
constexpr int mu_nodes = 48, alpha_nodes = 24, strata = 24;

float lambda(float mu, float alpha) {
  const float tan2 = std::max(0.0f, 1.0f - mu * mu) / std::max(mu * mu, 1e-12f);
  return 0.5f * (std::sqrt(1.0f + alpha * alpha * tan2) - 1.0f);
}

/// E is the mean of F·G2/G1 over visible normals (Heitz 2018, eq. 19); on a fixed grid of numbers, so that the table
/// is the same everywhere.
CoatAlbedo integrate(float mu, float alpha) {
  mu = std::max(mu, 1e-3f);
  alpha = std::max(alpha, 1e-3f);
  const Eigen::Vector3f wo(std::sqrt(std::max(0.0f, 1.0f - mu * mu)), 0.0f, mu);
  double a = 0.0, b = 0.0;
  for (int i = 0; i < strata; ++i) {
    for (int j = 0; j < strata; ++j) {
      const Eigen::Vector2f u((static_cast<float>(i) + 0.5f) / strata, (static_cast<float>(j) + 0.5f) / strata);
      const Eigen::Vector3f h = sample_visible_normal(wo, alpha, u);
      const float oh = std::max(0.0f, wo.dot(h));
      const float mu_i = 2.0f * oh * h.z() - wo.z();
      if (mu_i <= 0.0f) continue;
      const float lambda_o = lambda(mu, alpha);
      const float weight = (1.0f + lambda_o) / (1.0f + lambda_o + lambda(mu_i, alpha));
      const float x = std::pow(1.0f - oh, 5.0f);
      a += weight * (1.0f - x);
      b += weight * x;
    }
  }
  constexpr double count = strata * strata;
  return {static_cast<float>(a / count), static_cast<float>(b / count)};
}

CoatAlbedo mix(const CoatAlbedo& p, const CoatAlbedo& q, float t) {
  return {p.a + (q.a - p.a) * t, p.b + (q.b - p.b) * t};
}

struct Table {
  std::array<std::array<CoatAlbedo, mu_nodes>, alpha_nodes> directional;
  std::array<CoatAlbedo, alpha_nodes> mean;

  Table() {
    for (int j = 0; j < alpha_nodes; ++j) {
      const float s = static_cast<float>(j) / (alpha_nodes - 1);
      for (int i = 0; i < mu_nodes; ++i) {
        const float t = static_cast<float>(i) / (mu_nodes - 1);
        directional[j][i] = integrate(t * t, s * s);
      }
      // The mean of what the table interpolates, not of the truth: so base and coat balance.
      constexpr int steps = 2048;
      double a = 0.0, b = 0.0;
      for (int k = 0; k < steps; ++k) {
        const float mu = (static_cast<float>(k) + 0.5f) / steps;
        const CoatAlbedo e = row(j, mu);
        a += 2.0 * mu * e.a / steps;
        b += 2.0 * mu * e.b / steps;
      }
      mean[j] = {static_cast<float>(a), static_cast<float>(b)};
    }
  }

  CoatAlbedo row(int j, float mu) const {
    const float t = std::sqrt(std::clamp(mu, 0.0f, 1.0f)) * (mu_nodes - 1);
    const int i = std::min(static_cast<int>(t), mu_nodes - 2);
    return mix(directional[j][i], directional[j][i + 1], t - static_cast<float>(i));
  }
};

const Table& table() {
  static const Table instance;  // never changes, the same in every process
  return instance;
}

struct AlphaPlace {
  int index;
  float offset;
};

AlphaPlace place_of(float alpha) {
  const float s = std::sqrt(std::clamp(alpha, 0.0f, 1.0f)) * (alpha_nodes - 1);
  const int j = std::min(static_cast<int>(s), alpha_nodes - 2);
  return {j, s - static_cast<float>(j)};
}

}  // namespace

CoatAlbedo coat_albedo(float mu, float alpha) {
  const AlphaPlace place = place_of(alpha);
  return mix(table().row(place.index, mu), table().row(place.index + 1, mu), place.offset);
}

CoatAlbedo mean_coat_albedo(float alpha) {
  const AlphaPlace place = place_of(alpha);
  return mix(table().mean[place.index], table().mean[place.index + 1], place.offset);
}

}  // namespace vultus::render
