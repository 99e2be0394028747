#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "core/error.h"
#include "core/files.h"
#include "core/image.h"
#include "core/random.h"

namespace vultus {
namespace {

class ImageFiles : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(testing::TempDir()) / (std::string("vultus_image_") + info->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static std::string refusal(const std::filesystem::path& file) {
    try {
      read_image(file);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }
  std::filesystem::path folder_;
};

Image noise(int width, int height, std::vector<std::string> channels, double low, double high) {
  Random random(9);
  Image image(width, height, std::move(channels));
  for (float& value : image.pixels()) value = static_cast<float>(random.uniform(low, high));
  return image;
}

double largest_difference(const Image& a, const Image& b) {
  EXPECT_EQ(a.pixels().size(), b.pixels().size());
  double largest = 0;
  for (std::size_t i = 0; i < std::min(a.pixels().size(), b.pixels().size()); ++i)
    largest = std::max(largest, std::abs(static_cast<double>(a.pixels()[i]) - b.pixels()[i]));
  return largest;
}

TEST(Image, SamplesBilinearlyBetweenPixelCentres) {
  Image image(2, 2, {"v"});
  image.pixels() = {0, 1, 2, 3};
  EXPECT_FLOAT_EQ(image.sample(0.5, 0.5, 0), 0);
  EXPECT_FLOAT_EQ(image.sample(1.5, 1.5, 0), 3);
  EXPECT_FLOAT_EQ(image.sample(1.0, 1.0, 0), 1.5);
  EXPECT_FLOAT_EQ(image.sample(0.75, 0.5, 0), 0.25);
  EXPECT_FLOAT_EQ(image.sample(-5, 99, 0), 2);  // clamped to the bottom left
}

TEST(Image, SrgbCurveIsItsOwnInverse) {
  EXPECT_NEAR(srgb_from_linear(0.18f), 0.4613561, 1e-6);  // IEC 61966-2-1
  EXPECT_NEAR(linear_from_srgb(0.5f), 0.2140411, 1e-6);
  for (int i = 0; i <= 255; ++i)
    EXPECT_NEAR(srgb_from_linear(linear_from_srgb(static_cast<float>(i) / 255)), i / 255.0, 1e-6);
}

TEST(Image, RefusesAnEmptyShape) {
  EXPECT_THROW(Image(0, 4, {"R"}), InputError);
  EXPECT_THROW(Image(4, -1, {"R"}), InputError);
  EXPECT_THROW(Image(4, 4, {}), InputError);
}

TEST_F(ImageFiles, ExrKeepsChannelsInOrderAndFloatsExactly) {
  const Image image = noise(7, 5, {"jaw", "brow left", "R", "B", "zygomatic"}, -3, 1e5);
  write_image(folder_ / "a.exr", image);
  const Image read = read_image(folder_ / "a.exr");
  EXPECT_EQ(read.channel_names(), image.channel_names());
  EXPECT_EQ(read.pixels(), image.pixels());
}

TEST_F(ImageFiles, ExrOfColourIsHalf) {
  const Image image = noise(7, 5, {"R", "G", "B"}, 0, 8);
  write_image(folder_ / "a.exr", image);
  EXPECT_LT(largest_difference(read_image(folder_ / "a.exr"), image), 8.0 / 2048);  // 11 significant bits below 8
  EXPECT_NE(read_image(folder_ / "a.exr").pixels(), image.pixels());
  Image sun = image;
  *sun.at(3, 3) = 1e6f;  // beyond half's range the file is float
  write_image(folder_ / "sun.exr", sun);
  EXPECT_EQ(read_image(folder_ / "sun.exr").pixels(), sun.pixels());
}

TEST_F(ImageFiles, EightBitFilesAreEncodedAndDecoded) {
  const Image image = noise(16, 8, {"R", "G", "B"}, 0, 1);
  for (const char* name : {"a.png", "a.tif"}) {
    write_image(folder_ / name, image);
    const Image read = read_image(folder_ / name);
    // Half a step of 1/255 where the curve is steepest in linear light (slope 2.3 at 1).
    EXPECT_LT(largest_difference(read, image), 2.3 * 0.5 / 255 + 1e-5) << name;
    const Image raw = read_image(folder_ / name, Encoding::raw);
    EXPECT_NEAR(raw.at(3, 3)[1], srgb_from_linear(image.at(3, 3)[1]), 0.5 / 255 + 1e-5) << name;
  }
}

TEST_F(ImageFiles, JpegIsCloseForASmoothPicture) {
  Image image = Image::rgb(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) image.set_rgb(x, y, {x / 63.0f, 0.5f, y / 63.0f});
  write_image(folder_ / "a.jpg", image);
  EXPECT_LT(largest_difference(read_image(folder_ / "a.jpg"), image), 0.08);
}

TEST_F(ImageFiles, HdrKeepsRadiance) {
  const Image image = noise(32, 16, {"R", "G", "B"}, 1, 900);
  write_image(folder_ / "a.hdr", image);
  EXPECT_LT(largest_difference(read_image(folder_ / "a.hdr"), image), 1024.0 / 256);  // 8 bits shared exponent
}

TEST_F(ImageFiles, AlphaIsNeitherDecodedNorMultipliedIn) {
  Image image(2, 1, {"R", "G", "B", "A"});
  image.pixels() = {0.5f, 0.25f, 0.75f, 0.5f, 0.5f, 0.25f, 0.75f, 0.0f};
  write_image(folder_ / "a.png", image);
  EXPECT_LT(largest_difference(read_image(folder_ / "a.png"), image), 2.3 * 0.5 / 255 + 1e-5);
}

TEST_F(ImageFiles, OutOfRangeValuesAreClampedInEightBits) {
  Image image = Image::rgb(1, 1);
  image.pixels() = {-4, 7, std::numeric_limits<float>::quiet_NaN()};
  write_image(folder_ / "a.png", image);
  EXPECT_EQ(read_image(folder_ / "a.png").pixels(), (std::vector<float>{0, 1, 0}));
}

TEST_F(ImageFiles, EqualImagesMakeEqualFiles) {
  const Image image = noise(16, 8, {"R", "G", "B"}, 0, 1);
  for (const std::string extension : {".exr", ".png", ".jpg", ".tif"}) {
    write_image(folder_ / ("a" + extension), image);
    write_image(folder_ / ("b" + extension), image);
    EXPECT_EQ(read_file(folder_ / ("a" + extension)), read_file(folder_ / ("b" + extension))) << extension;
  }
}

TEST_F(ImageFiles, TruncatedFilesAreRefused) {
  const Image image = noise(64, 48, {"R", "G", "B"}, 0, 1);
  for (const std::string extension : {".exr", ".png", ".jpg", ".tif", ".hdr"}) {
    const auto file = folder_ / ("a" + extension);
    write_image(file, image);
    const std::string whole = read_file(file);
    for (const double part : {0.0, 0.001, 0.01, 0.1, 0.5, 0.9}) {
      write_file(file, whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
      EXPECT_NE(refusal(file), "accepted") << extension << " " << part;
      EXPECT_NE(refusal(file).find("a" + extension), std::string::npos) << refusal(file);
    }
  }
}

TEST_F(ImageFiles, AbsurdSizesAreRefusedBeforeAllocation) {
  // A PNG header of 65536 by 65536 pixels with the right checksum, and nothing after it.
  const std::string png("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\x01\0\0\0\x01\0\0\x08\x02\0\0\0\xe3\xe6\xa7\xb4", 33);
  write_file(folder_ / "a.png", png);
  EXPECT_NE(refusal(folder_ / "a.png"), "accepted");
  write_file(folder_ / "b.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100000 +X 100000\n");
  EXPECT_NE(refusal(folder_ / "b.hdr").find("absurdly large"), std::string::npos) << refusal(folder_ / "b.hdr");
}

TEST_F(ImageFiles, OtherContentIsRefused) {
  write_file(folder_ / "text.png", "this is no picture\n");
  write_file(folder_ / "text.exr", std::string(5000, 'x'));
  EXPECT_NE(refusal(folder_ / "text.png"), "accepted");
  EXPECT_NE(refusal(folder_ / "text.exr"), "accepted");
  EXPECT_NE(refusal(folder_ / "missing.png").find("no such file"), std::string::npos);
  EXPECT_NE(refusal(folder_).find("folder"), std::string::npos);
}

TEST_F(ImageFiles, ValuesThatAreNotFiniteAreNamed) {
  Image image = noise(7, 5, {"R", "G", "B"}, 0, 8);
  image.at(4, 2)[1] = std::numeric_limits<float>::quiet_NaN();
  write_image(folder_ / "a.exr", image);
  EXPECT_NE(refusal(folder_ / "a.exr").find("pixel (4, 2), channel G"), std::string::npos)
      << refusal(folder_ / "a.exr");
}

TEST_F(ImageFiles, WhatCannotBeWrittenIsSaid) {
  const Image image = noise(4, 4, {"R", "G", "B"}, 0, 1);
  EXPECT_THROW(write_image(folder_ / "a.xyz", image), OutputError);
  EXPECT_THROW(write_image(folder_ / "a.png", noise(4, 4, {"a", "b", "c", "d", "e"}, 0, 1)), OutputError);
  EXPECT_THROW(write_image(folder_ / "a.exr", noise(4, 4, {"a", "a"}, 0, 1)), OutputError);
  EXPECT_THROW(write_image(folder_ / "a.exr", Image()), OutputError);
  write_file(folder_ / "file", "x");
  EXPECT_THROW(write_image(folder_ / "file" / "a.png", image), OutputError);
  for (const auto& entry : std::filesystem::directory_iterator(folder_))
    EXPECT_EQ(entry.path().filename(), "file") << "nothing half-written stays";
}

}  // namespace
}  // namespace vultus
