#include <gtest/gtest.h>

#include <set>

#include "render/sampler.h"

namespace vultus::render {
namespace {

TEST(Sampler, EveryPairOfDimensionsIsANet) {
  // The first 2^4 points of a (0, 2)-sequence have one point in each of the 16 boxes of every power-of-two shape, and
  // Owen scrambling keeps that.
  for (std::uint64_t pixel = 0; pixel < 20; ++pixel) {
    Sampler sampler(7, pixel);
    for (int pair = 0; pair < 5; ++pair) {
      for (const int columns : {1, 2, 4, 8, 16}) {
        const int rows = 16 / columns;
        std::set<int> boxes;
        for (std::uint32_t s = 0; s < 16; ++s) {
          sampler.start(s);
          for (int skipped = 0; skipped < pair; ++skipped) sampler.next_2d();
          const Eigen::Vector2f u = sampler.next_2d();
          ASSERT_GE(u.minCoeff(), 0.0f);
          ASSERT_LT(u.maxCoeff(), 1.0f);
          boxes.insert(static_cast<int>(u.y() * rows) * columns + static_cast<int>(u.x() * columns));
        }
        EXPECT_EQ(boxes.size(), 16u) << "pixel " << pixel << ", pair " << pair << ", " << columns << " columns";
      }
    }
  }
}

TEST(Sampler, DependsOnSeedPixelSampleAndDimensionOnly) {
  const auto draw = [](std::uint64_t seed, std::uint64_t pixel, std::uint32_t index, int dimension) {
    Sampler sampler(seed, pixel);
    sampler.start(index);
    for (int d = 0; d < dimension; ++d) sampler.next_2d();
    return sampler.next_2d();
  };
  EXPECT_EQ(draw(1, 2, 3, 4), draw(1, 2, 3, 4));
  EXPECT_NE(draw(1, 2, 3, 4), draw(9, 2, 3, 4));
  EXPECT_NE(draw(1, 2, 3, 4), draw(1 + (std::uint64_t{1} << 40), 2, 3, 4));
  EXPECT_NE(draw(1, 2, 3, 4), draw(1, 9, 3, 4));
  EXPECT_NE(draw(1, 2, 3, 4), draw(1, 2 + (std::uint64_t{1} << 32), 3, 4));
  EXPECT_NE(draw(1, 2, 3, 4), draw(1, 2, 9, 4));
  EXPECT_NE(draw(1, 2, 3, 4), draw(1, 2, 3, 9));
}

TEST(Sampler, PixelsAndPairsAreUncorrelated) {
  // Products of centred draws: mean 0, standard deviation 1/12 each.
  constexpr int n = 20000;
  double across_pixels = 0, across_pairs = 0;
  for (int pixel = 0; pixel < n; ++pixel) {
    Sampler a(1, pixel), b(1, pixel + 1);
    a.start(0);
    b.start(0);
    const float first = a.next_2d().x() - 0.5f;
    across_pixels += first * (b.next_2d().x() - 0.5f);
    across_pairs += first * (a.next_2d().x() - 0.5f);
  }
  const double four_errors = 4.0 / 12.0 / std::sqrt(n);
  EXPECT_NEAR(across_pixels / n, 0.0, four_errors);
  EXPECT_NEAR(across_pairs / n, 0.0, four_errors);
}

}  // namespace
}  // namespace vultus::render
