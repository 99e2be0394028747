#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>

#include "core/error.h"
#include "core/random.h"
#include "render/environment.h"
#include "tests/unit/render/chi_square.h"

namespace vultus::render {
namespace {

using Eigen::Vector3f;

/// 16×8, dim, with one bright texel.
Image lamp(int x, int y) {
  Image image = Image::rgb(16, 8);
  for (float& value : image.pixels()) value = 0.1f;
  image.set_rgb(x, y, {40, 40, 40});
  return image;
}

Vector3f texel_direction(int x, int y) {
  const double theta = std::numbers::pi * (y + 0.5) / 8, phi = 2 * std::numbers::pi * ((x + 0.5) / 16 - 0.5);
  return Eigen::Vector3d(std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi))
      .cast<float>();
}

Environment::Sample draw(const Environment& environment, Random& random) {
  return environment.sample({static_cast<float>(random.uniform()), static_cast<float>(random.uniform())});
}

TEST(Environment, CentreOfTheMapLiesAlongMinusZAndItsRightAlongX) {
  EXPECT_LT(texel_direction(8, 4).z(), -0.9f);  // this test's own idea of the map
  EXPECT_GT(texel_direction(12, 4).x(), 0.9f);
  EXPECT_GT(texel_direction(3, 0).y(), 0.9f);
  for (const auto& [x, y] : {std::pair{8, 4}, {12, 4}, {3, 1}, {0, 6}, {15, 3}}) {
    const Environment environment(lamp(x, y));
    EXPECT_NEAR(environment.radiance(texel_direction(x, y))[1], 40.0f, 0.01f) << x << " " << y;
    EXPECT_LT(environment.radiance(-texel_direction(x, y))[1], 0.2f);
  }
}

TEST(Environment, RotationTurnsTheLightAboutY) {
  // Counter-clockwise seen from above, +z goes to +x, so what lay along -z comes to lie along -x.
  const Environment environment(lamp(8, 4), std::numbers::pi / 2);
  const Vector3f was = texel_direction(8, 4);
  EXPECT_NEAR(environment.radiance({was.z(), was.y(), -was.x()})[0], 40.0f, 0.05f);
}

TEST(Environment, IntensityScalesAndNegativeLightIsNone) {
  Image image = lamp(8, 4);
  image.set_rgb(2, 2, {-5, -5, -5});
  const Environment environment(image, 0.0, 2.0);
  EXPECT_NEAR(environment.radiance(texel_direction(8, 4))[0], 80.0f, 0.02f);
  EXPECT_NEAR(environment.radiance(texel_direction(2, 2)).norm(), 0.0f, 1e-4f);
}

class EnvironmentDensity : public testing::TestWithParam<int> {
 protected:
  static Environment make(int kind) {
    if (kind == 0) return Environment::constant({1, 1, 1});
    if (kind == 1) return Environment(lamp(5, 2), 0.3);
    return Environment::studio();
  }
};

TEST_P(EnvironmentDensity, IntegratesToOne) {
  const Environment environment = make(GetParam());
  constexpr int rows = 1024, columns = 1536;
  double total = 0;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const double theta = std::numbers::pi * (r + 0.5) / rows, phi = 2 * std::numbers::pi * (c + 0.5) / columns;
      const Eigen::Vector3d w(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
      total += environment.pdf(w.cast<float>()) * std::sin(theta) * 2 * std::numbers::pi * std::numbers::pi /
               (static_cast<double>(rows) * columns);
    }
  EXPECT_NEAR(total, 1.0, 2e-3);  // the density jumps at texel borders, which the grid crosses at random
}

TEST_P(EnvironmentDensity, SamplesFollowIt) {
  const Environment environment = make(GetParam());
  Random random(3);
  const double p = direction_test([&] { return draw(environment, random).direction; },
                                  [&](const Vector3f& w) { return environment.pdf(w); }, 100000);
  EXPECT_GT(p, 1e-4);
}

TEST_P(EnvironmentDensity, SampleReportsItsOwnDensityAndRadiance) {
  const Environment environment = make(GetParam());
  Random random(4);
  int differing = 0;
  for (int i = 0; i < 2000; ++i) {
    const Environment::Sample s = draw(environment, random);
    EXPECT_NEAR(s.direction.norm(), 1.0f, 1e-5f);
    EXPECT_NEAR((s.radiance - environment.radiance(s.direction)).norm(), 0.0f, 2e-3f * s.radiance.norm() + 1e-3f);
    differing += std::abs(s.pdf - environment.pdf(s.direction)) > 1e-3f * s.pdf;
  }
  EXPECT_LT(differing, 5);  // directions that rounding carries over a texel border
}

TEST_P(EnvironmentDensity, IsPositiveWhereverThereIsLight) {
  const Environment environment = make(GetParam());
  Random random(5);
  for (int i = 0; i < 5000; ++i) {
    const Vector3f w = Vector3f(static_cast<float>(random.normal()), static_cast<float>(random.normal()),
                                static_cast<float>(random.normal()))
                           .normalized();
    if (environment.radiance(w).norm() > 0) {
      EXPECT_GT(environment.pdf(w), 0.0f);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Each, EnvironmentDensity, testing::Values(0, 1, 2));

TEST(Environment, BlackLightHasNoDensity) {
  const Environment environment = Environment::constant({0, 0, 0});
  EXPECT_EQ(environment.pdf({0, 0, 1}), 0.0f);
  EXPECT_EQ(environment.sample({0.3f, 0.6f}).pdf, 0.0f);
}

TEST(Environment, RefusesWhatIsNoLight) {
  EXPECT_THROW(Environment{Image()}, InputError);
  EXPECT_THROW(Environment(lamp(1, 1), 0.0, -1.0), InputError);
  EXPECT_THROW(Environment(lamp(1, 1), std::nan("")), InputError);
  EXPECT_THROW(Environment::load("no-such-file.exr"), InputError);
}

TEST(Environment, RealHdrsIntegrateConsistently) {
  const char* data = std::getenv("VULTUS_DATA");
  const auto file = std::filesystem::path(data ? data : "") / "hdri" / "sunset.exr";
  if (!data || !std::filesystem::exists(file)) GTEST_SKIP() << "VULTUS_DATA is not set";
  const Environment environment = Environment::load(file);
  // Irradiance of an upward surface by importance sampling and by uniform directions.
  Random random(6);
  double importance = 0, squares = 0, uniform = 0, uniform_squares = 0;
  constexpr int n = 200000;
  for (int i = 0; i < n; ++i) {
    const Environment::Sample s = draw(environment, random);
    const double x = s.pdf > 0 ? s.radiance[1] * std::max(0.0f, s.direction.y()) / s.pdf : 0.0;
    importance += x / n;
    squares += x * x / n;
    const double up = random.uniform(-1, 1), phi = 2 * std::numbers::pi * random.uniform(), r = std::sqrt(1 - up * up);
    const Eigen::Vector3d w(r * std::cos(phi), up, r * std::sin(phi));
    const double y = environment.radiance(w.cast<float>())[1] * std::max(0.0, up) * 4 * std::numbers::pi;
    uniform += y / n;
    uniform_squares += y * y / n;
  }
  const double error = std::sqrt((squares - importance * importance + uniform_squares - uniform * uniform) / n);
  EXPECT_NEAR(importance, uniform, 4 * error);
  EXPECT_LT(squares - importance * importance, uniform_squares - uniform * uniform);  // it is worth it
}

}  // namespace
}  // namespace vultus::render
