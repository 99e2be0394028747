#include <gtest/gtest.h>

#include <numbers>

#include "core/error.h"
#include "mocap/filter.h"
#include "mocap/spikes.h"
#include "tests/unit/mocap/takes.h"

namespace vultus::mocap {
namespace {

Take line(int frames) {
  Take take = Take::empty("line", 100.0, {"a"}, frames);
  for (int f = 0; f < frames; ++f) take.set(f, 0, {0.5 * f, 10.0 - 0.25 * f, 3.0});
  return take;
}

Take sine(int frames, double hz, double amplitude = 1.0) {
  Take take = Take::empty("sine", 100.0, {"a"}, frames);
  for (int f = 0; f < frames; ++f) take.set(f, 0, {amplitude * std::sin(2 * std::numbers::pi * hz * f / 100.0), 0, 0});
  return take;
}

/// Gain of the middle of a long sine.
double gain(const Take& before, const Take& after) {
  double product = 0.0, power = 0.0;
  for (int f = before.frames() / 4; f < 3 * before.frames() / 4; ++f) {
    product += before.at(f, 0).x() * after.at(f, 0).x();
    power += before.at(f, 0).x() * before.at(f, 0).x();
  }
  return product / power;
}

const FilterOptions kAll[] = {
    {Smoothing::three_frame}, {Smoothing::butterworth, 8.0}, {Smoothing::gaussian, 8.0, 0.03}};

TEST(Filter, ThreeFrameMeanByHand) {
  Take take = Take::empty("t", 60.0, {"a"}, 4);
  for (int f = 0; f < 4; ++f) take.set(f, 0, {f == 1 ? 3.0 : 0.0, 0, 0});
  const Take smooth = smoothed(take, {Smoothing::three_frame});
  EXPECT_FLOAT_EQ(static_cast<float>(smooth.at(1, 0).x()), 1.0F);
  EXPECT_FLOAT_EQ(static_cast<float>(smooth.at(2, 0).x()), 1.0F);
  EXPECT_FLOAT_EQ(static_cast<float>(smooth.at(3, 0).x()), 0.0F);
  EXPECT_FLOAT_EQ(static_cast<float>(smooth.at(0, 0).x()), 0.0F);  // (−3 + 0 + 3) / 3: reflected through the end
}

TEST(Filter, StraightMotionAndConstantsStay) {
  const Take take = line(50);
  for (const FilterOptions& options : kAll) {
    const Take smooth = smoothed(take, options);
    for (int f = 0; f < 50; ++f) EXPECT_LT((smooth.at(f, 0) - take.at(f, 0)).norm(), 2e-5) << f;  // floats
  }
}

TEST(Filter, ButterworthHalvesThePowerAtItsCutoffWithoutDelay) {
  const FilterOptions options{Smoothing::butterworth, 10.0};
  EXPECT_NEAR(gain(sine(1000, 10.0), smoothed(sine(1000, 10.0), options)), std::numbers::sqrt2 / 2, 0.01);
  EXPECT_NEAR(gain(sine(1000, 1.0), smoothed(sine(1000, 1.0), options)), 1.0, 1e-3);
  EXPECT_LT(gain(sine(1000, 40.0), smoothed(sine(1000, 40.0), options)), 0.005);
}

TEST(Filter, GaussianGainIsTheGaussiansTransform) {
  const double s = 0.03, hz = 5.0, w = 2 * std::numbers::pi * hz;
  const FilterOptions options{Smoothing::gaussian, 8.0, s};
  EXPECT_NEAR(gain(sine(1000, hz), smoothed(sine(1000, hz), options)), std::exp(-0.5 * s * s * w * w), 0.01);
}

TEST(Filter, NothingIsSmoothedAcrossAHole) {
  for (const FilterOptions& options : kAll) {
    Take take = line(60);
    for (int f = 30; f < 60; ++f) take.set(f, 0, take.at(f, 0) + Eigen::Vector3d(50, 0, 0));
    take.drop(30, 0);
    const Take smooth = smoothed(take, options);
    EXPECT_EQ(smooth.present, take.present);
    for (int f : {28, 29, 31, 32}) EXPECT_LT((smooth.at(f, 0) - take.at(f, 0)).norm(), 2e-5) << f;
  }
}

TEST(Filter, OptionsAreChecked) {
  EXPECT_THROW(smoothed(line(5), {Smoothing::butterworth, 0.0}), UsageError);
  EXPECT_THROW(smoothed(line(5), {Smoothing::gaussian, 8.0, -1.0}), UsageError);
  const Take take = line(5);
  EXPECT_EQ(smoothed(take, {Smoothing::butterworth, 50.0}).positions, take.positions);
}

TEST(Spikes, FoundAndNothingElse) {
  Take take = sine(400, 1.5, 10.0);
  Random random(2);
  for (int f = 0; f < 400; ++f) take.set(f, 0, take.at(f, 0) + jitter(random, 0.05));
  EXPECT_TRUE(find_spikes(take).empty());
  take.set(100, 0, take.at(100, 0) + Eigen::Vector3d(0, 4, 0));
  for (int f : {200, 201}) take.set(f, 0, take.at(f, 0) + Eigen::Vector3d(0, 0, -6));
  const std::vector<Spike> spikes = find_spikes(take);
  ASSERT_EQ(spikes.size(), 2U);
  EXPECT_EQ(spikes[0].first, 100);
  EXPECT_EQ(spikes[0].last, 100);
  EXPECT_NEAR(spikes[0].size, 4.0, 0.5);
  EXPECT_EQ(spikes[1].first, 200);
  EXPECT_EQ(spikes[1].last, 201);
  const Take clean = without(take, spikes);
  EXPECT_FALSE(clean.has(100, 0));
  EXPECT_TRUE(clean.has(99, 0));
}

TEST(Spikes, AStepIsNoSpike) {
  Take take = line(100);
  for (int f = 50; f < 100; ++f) take.set(f, 0, take.at(f, 0) + Eigen::Vector3d(0, 0, 5));
  EXPECT_TRUE(find_spikes(take).empty());
}

TEST(SpikesReal, FastBrowsAreNotSpikes) {
  const auto data = real_data() / "animface-markers";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "VULTUS_DATA has no animface-markers";
  EXPECT_LE(find_spikes(read_take(data / "Eyebrows.c3d")).size(), 3U);
}

}  // namespace
}  // namespace vultus::mocap
