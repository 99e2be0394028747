#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/random.h"
#include "render/bsdf.h"
#include "render/coat_albedo.h"
#include "tests/unit/render/chi_square.h"

namespace vultus::render {
namespace {

using Eigen::Vector3f;

Vector3f at_angle(double degrees, double azimuth = 0.4) {
  const double t = degrees * std::numbers::pi / 180;
  return Eigen::Vector3d(std::sin(t) * std::cos(azimuth), std::sin(t) * std::sin(azimuth), std::cos(t)).cast<float>();
}

Vector3f random_up(Random& random) {
  const Vector3f w(static_cast<float>(random.normal()), static_cast<float>(random.normal()),
                   static_cast<float>(random.normal()));
  return Vector3f(w.x(), w.y(), std::abs(w.z()) + 1e-3f).normalized();
}

/// ∫ f cosθ dω over the upper hemisphere on a grid, in the first channel.
double reflectance(const Bsdf& bsdf) {
  constexpr int rows = 600, columns = 200;
  double total = 0;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const double t = (r + 0.5) / rows, z = t * t;  // finer towards the horizon
      const double phi = 2 * std::numbers::pi * (c + 0.5) / columns, s = std::sqrt(1 - z * z);
      const Eigen::Vector3d wi(s * std::cos(phi), s * std::sin(phi), z);
      total +=
          bsdf.value(wi.cast<float>())[0] * z * 2 * t * 2 * std::numbers::pi / (static_cast<double>(rows) * columns);
    }
  return total;
}

const Skin plain{Vector3f(0.7f, 0.4f, 0.2f), 0.3f, 0.0f, 0.0f};

class Skins : public testing::TestWithParam<double> {  // perceptual roughness
 protected:
  Skin skin(float albedo) const {
    return {Vector3f::Constant(albedo), alpha_from_roughness(static_cast<float>(GetParam())), f0_from_ior(1.4f), 1.0f};
  }
};

TEST(Bsdf, FresnelAtNormalIncidence) { EXPECT_NEAR(f0_from_ior(1.4f), 0.0277778f, 1e-6f); }

TEST(Bsdf, WithoutACoatItIsLambert) {
  const Bsdf bsdf(plain, at_angle(50));
  EXPECT_NEAR(bsdf.value(at_angle(20))[0], 0.7 / std::numbers::pi, 1e-6);
  EXPECT_NEAR(bsdf.value(at_angle(80))[2], 0.2 / std::numbers::pi, 1e-6);
  EXPECT_NEAR(reflectance(bsdf), 0.7, 1e-4);
  EXPECT_EQ(bsdf.value(-at_angle(20)).norm(), 0.0f);
  EXPECT_EQ(Bsdf(plain, -at_angle(50)).value(at_angle(20)).norm(), 0.0f);
}

TEST_P(Skins, IsReciprocal) {
  Random random(1);
  for (int i = 0; i < 300; ++i) {
    const Vector3f a = random_up(random), b = random_up(random);
    const float forward = Bsdf(skin(0.6f), a).value(b)[0], backward = Bsdf(skin(0.6f), b).value(a)[0];
    EXPECT_NEAR(forward, backward, 1e-4f * forward);
  }
}

TEST_P(Skins, WhiteFurnaceReturnsEverything) {
  for (const double angle : {0.0, 30.0, 60.0, 80.0})
    // The table is interpolated (2e-3) and narrow lobes strain the quadrature.
    EXPECT_NEAR(reflectance(Bsdf(skin(1.0f), at_angle(angle))), 1.0, 0.012) << angle;
}

TEST_P(Skins, NeverReturnsMoreThanArrives) {
  for (const double angle : {0.0, 45.0, 75.0, 85.0, 89.0})
    for (const float albedo : {0.0f, 0.5f, 0.9f})
      EXPECT_LT(reflectance(Bsdf(skin(albedo), at_angle(angle))), 1.0) << angle << " " << albedo;
}

TEST_P(Skins, CoatAlbedoIsTheIntegralOfTheCoat) {
  for (const double angle : {10.0, 50.0, 75.0}) {
    const Bsdf coat(skin(0.0f), at_angle(angle));
    EXPECT_NEAR(coat.coat_albedo(), reflectance(coat), 0.004 + 0.02 * coat.coat_albedo()) << angle;
  }
}

TEST_P(Skins, SamplesFollowTheDensity) {
  Random random(2);
  for (const double angle : {5.0, 45.0, 80.0}) {
    const Bsdf bsdf(skin(0.5f), at_angle(angle));
    const auto draw = [&]() -> Vector3f {
      const Vector3f wi = bsdf.sample(static_cast<float>(random.uniform()),
                                      {static_cast<float>(random.uniform()), static_cast<float>(random.uniform())});
      return wi.z() > 0 ? wi : Vector3f::Zero();
    };
    EXPECT_GT(direction_test(
                  draw, [&](const Vector3f& w) { return bsdf.pdf(w); }, 60000),
              1e-4)
        << angle;
  }
}

TEST_P(Skins, SamplingIsUnbiased) {
  // The estimator f·cos/pdf averages to the reflectance.
  Random random(3);
  const Bsdf bsdf(skin(0.5f), at_angle(60));
  constexpr int n = 40000;
  double sum = 0, squares = 0;
  for (int i = 0; i < n; ++i) {
    const Vector3f wi = bsdf.sample(static_cast<float>(random.uniform()),
                                    {static_cast<float>(random.uniform()), static_cast<float>(random.uniform())});
    const float pdf = bsdf.pdf(wi);
    const double x = pdf > 0 ? bsdf.value(wi)[0] * wi.z() / pdf : 0.0;
    sum += x;
    squares += x * x;
  }
  const double mean = sum / n, error = std::sqrt((squares / n - mean * mean) / n);
  EXPECT_NEAR(mean, reflectance(bsdf), 4 * error + 0.006);
  EXPECT_LT(std::sqrt(squares / n - mean * mean), 0.5 * mean);  // a density that fits keeps the weights even
}

INSTANTIATE_TEST_SUITE_P(Roughness, Skins, testing::Values(0.4, 0.6, 0.9));

TEST(VisibleNormals, FollowTheirDensity) {
  Random random(4);
  for (const float alpha : {0.15f, 0.5f, 0.9f})
    for (const double angle : {0.0, 50.0, 85.0}) {
      const Vector3f wo = at_angle(angle);
      const auto draw = [&] {
        return sample_visible_normal(wo, alpha,
                                     {static_cast<float>(random.uniform()), static_cast<float>(random.uniform())});
      };
      const auto pdf = [&](const Vector3f& h) { return visible_normal_pdf(wo, h, alpha); };
      EXPECT_GT(direction_test(draw, pdf, 60000, 96), 1e-4) << alpha << " " << angle;
    }
}

TEST(CoatAlbedo, SmoothCoatReflectsAsFresnelSays) {
  // For a narrow lobe E(μ) is Schlick's term itself: a = 1 - (1-μ)^5, b = (1-μ)^5.
  for (const float mu : {1.0f, 0.6f, 0.3f}) {
    const float x = std::pow(1.0f - mu, 5.0f);
    EXPECT_NEAR(coat_albedo(mu, 1e-3f).a, 1.0f - x, 3e-3f) << mu;
    EXPECT_NEAR(coat_albedo(mu, 1e-3f).b, x, 3e-3f) << mu;
  }
}

TEST(CoatAlbedo, MeanIsTheCosineWeightedMean) {
  for (const float alpha : {0.1f, 0.4f}) {
    double a = 0, b = 0;
    for (int i = 0; i < 5000; ++i) {
      const float mu = (static_cast<float>(i) + 0.5f) / 5000;
      a += 2 * mu * coat_albedo(mu, alpha).a / 5000;
      b += 2 * mu * coat_albedo(mu, alpha).b / 5000;
    }
    EXPECT_NEAR(mean_coat_albedo(alpha).a, a, 1e-4);
    EXPECT_NEAR(mean_coat_albedo(alpha).b, b, 1e-4);
  }
}

}  // namespace
}  // namespace vultus::render
