#include <gtest/gtest.h>

#include <cmath>

#include "apps/bench_registration/statistics.h"

namespace vultus::apps::bench {
namespace {

TEST(Statistics, QuantilesInterpolateBetweenRanks) {
  EXPECT_DOUBLE_EQ(quantile({4, 1, 3, 2}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(quantile({4, 1, 3, 2}, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(quantile({4, 1, 3, 2}, 1.0), 4.0);
  EXPECT_DOUBLE_EQ(quantile({7}, 0.95), 7.0);
  EXPECT_NEAR(quantile({0, 10, 20, 30, 40}, 0.95), 38.0, 1e-12);  // rank 3.8
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

TEST(Statistics, PoolWeighsScansAlikeInTheMeanAndDistancesAlikeInQuantiles) {
  Pool pool;
  EXPECT_TRUE(pool.empty());
  EXPECT_TRUE(std::isnan(pool.mean()));
  pool.add({1, 1, 1, 1});
  pool.add({3, 5});
  pool.add({});                               // a scan without data says nothing
  EXPECT_DOUBLE_EQ(pool.mean(), 2.5);         // of 1 and 4, not of six values
  EXPECT_DOUBLE_EQ(pool.quantile(0.5), 1.0);  // of six values
  EXPECT_DOUBLE_EQ(pool.quantile(1.0), 5.0);
}

}  // namespace
}  // namespace vultus::apps::bench
