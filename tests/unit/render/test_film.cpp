#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "render/film.h"

namespace vultus::render {
namespace {

TEST(PixelSum, AveragesAndKeepsWhatTheMeshCovers) {
  PixelSum sum;
  PathSample seen;
  seen.radiance = {3, 3, 3};
  seen.covered = true;
  seen.albedo = {0.5f, 0.4f, 0.2f};
  seen.normal = {0, 0, 1};
  seen.depth = 100;
  sum.add(seen);
  seen.normal = {0, 1, 0};
  seen.depth = 102;
  sum.add(seen);
  PathSample sky;
  sky.radiance = {1, 0, 0};
  sum.add(sky);
  sum.add(sky);
  float pixel[11];
  sum.store(pixel);
  EXPECT_FLOAT_EQ(pixel[0], 2.0f);
  EXPECT_FLOAT_EQ(pixel[1], 1.5f);
  EXPECT_FLOAT_EQ(pixel[3], 0.5f);
  EXPECT_FLOAT_EQ(pixel[4], 0.25f);
  EXPECT_FLOAT_EQ(pixel[8], std::sqrt(0.5f));
  EXPECT_FLOAT_EQ(pixel[10], 101.0f);
}

TEST(PixelSum, ErrorIsTheVarianceOfTheMean) {
  PixelSum sum;
  for (const float value : {1.0f, 2.0f, 3.0f, 6.0f}) {
    PathSample sample;
    sample.radiance.setConstant(value);
    sum.add(sample);
  }
  // Mean 3, squared deviations 4 + 1 + 0 + 9 = 14; unbiased variance 14/3, of the mean of four 14/12.
  EXPECT_NEAR(sum.luminance(), 3.0, 1e-6);
  EXPECT_NEAR(sum.squared_error(), 14.0 / 12.0, 1e-6);
}

TEST(Film, CurvesAreWhatTheySay) {
  Image layers = make_layers(4, 1);
  const float values[] = {0.25f, 0.5f, 1.0f, 40.0f};
  for (int x = 0; x < 4; ++x) layers.set_rgb(x, 0, Eigen::Vector3f::Constant(values[x]));
  const Image clipped = developed(layers, ToneCurve::srgb), film = developed(layers, ToneCurve::filmic);
  EXPECT_FLOAT_EQ(clipped.rgb_at(2, 0)[0], 1.0f);
  EXPECT_FLOAT_EQ(film.rgb_at(0, 0)[0], 0.25f);
  EXPECT_FLOAT_EQ(film.rgb_at(1, 0)[0], 0.5f);
  EXPECT_NEAR(film.rgb_at(2, 0)[0], 1.0 - 0.5 * std::exp(-1.0), 1e-6);
  EXPECT_NEAR(film.rgb_at(3, 0)[0], 1.0, 1e-6);
  EXPECT_FLOAT_EQ(developed(layers, ToneCurve::srgb, 1.0).rgb_at(0, 0)[2], 0.5f);
}

TEST(Film, FrameIsWrittenTwice) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "vultus_film";
  std::filesystem::remove_all(folder);
  Image layers = make_layers(3, 2);
  for (std::size_t i = 0; i < layers.pixels().size(); ++i) layers.pixels()[i] = 0.01f * static_cast<float>(i);
  write_frame(folder / "0007.exr", layers, ToneCurve::filmic);
  const Image read = read_image(folder / "0007.exr");
  EXPECT_EQ(read.channel_names(), layers.channel_names());
  EXPECT_EQ(read.pixels(), layers.pixels());
  EXPECT_NEAR(read_image(folder / "0007.png").rgb_at(1, 0)[0], layers.rgb_at(1, 0)[0], 0.005f);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace vultus::render
