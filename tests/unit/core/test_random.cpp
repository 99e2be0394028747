#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/random.h"

namespace vultus {
namespace {

TEST(Random, IsPcg32AsPublished) {
  // The first outputs of pcg32 for state 42, stream 54, as printed by the reference implementation's demo.
  Random random(42, 54);
  for (const std::uint32_t expected : {0xa15c02b7u, 0x7b47f409u, 0xba1d3330u, 0x83d2f293u, 0xbfa4784bu, 0xcbed606eu})
    EXPECT_EQ(random.next(), expected);
}

TEST(Random, SeedAndStreamChangeTheSequence) {
  Random a(1), again(1), other_seed(2), other_stream(1, 1);
  const std::uint32_t first = a.next();
  EXPECT_EQ(first, again.next());
  EXPECT_NE(first, other_seed.next());
  EXPECT_NE(first, other_stream.next());
}

TEST(Random, UniformIsUniform) {
  Random random(7);
  constexpr int n = 100000, bins = 50;
  std::array<int, bins> count{};
  for (int i = 0; i < n; ++i) {
    const double u = random.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    ++count[static_cast<int>(u * bins)];
  }
  double chi2 = 0;
  for (const int c : count) chi2 += (c - n / bins) * (c - n / bins) / static_cast<double>(n / bins);
  EXPECT_LT(chi2, 94.0);  // 49 degrees of freedom: exceeded once in 10^4 seeds
}

TEST(Random, NormalHasMomentsOfTheNormalDistribution) {
  Random random(3);
  constexpr int n = 200000;
  double sum = 0, squares = 0, fourth = 0;
  for (int i = 0; i < n; ++i) {
    const double x = random.normal();
    sum += x;
    squares += x * x;
    fourth += x * x * x * x;
  }
  EXPECT_NEAR(sum / n, 0.0, 4.0 / std::sqrt(n));  // four standard errors each
  EXPECT_NEAR(squares / n, 1.0, 4.0 * std::sqrt(2.0 / n));
  EXPECT_NEAR(fourth / n, 3.0, 4.0 * std::sqrt(96.0 / n));
}

TEST(Random, BelowReachesEveryValueEqually) {
  Random random(11);
  constexpr int n = 70000;
  std::array<int, 7> count{};
  for (int i = 0; i < n; ++i) ++count[random.below(7)];
  for (const int c : count) EXPECT_NEAR(c, n / 7, 4.5 * std::sqrt(n / 7.0));
  EXPECT_EQ(Random(1).below(1), 0);
}

}  // namespace
}  // namespace vultus
