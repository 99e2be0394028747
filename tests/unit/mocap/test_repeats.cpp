#include <gtest/gtest.h>

#include "mocap/clean.h"
#include "mocap/repeats.h"
#include "tests/unit/mocap/takes.h"

namespace vultus::mocap {
namespace {

/// 20 markers that sway together by up to 12 mm at 0.5 Hz, 0.1 mm of noise.
Take swaying(int frames) {
  const Points face = face_markers(20);
  Take take = Take::empty("sway", 120.0, numbered("m", 20), frames);
  Random random(3);
  for (int f = 0; f < frames; ++f) {
    for (int m = 0; m < 20; ++m) {
      const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
      take.set(f, m, face.row(m).transpose() + Eigen::Vector3d(12.0 * std::sin(0.026 * f), 0, 0) + 0.1 * noise);
    }
  }
  return take;
}

void copy_frame(Take& take, int from, int to) {
  for (int m = 0; m < take.markers(); ++m) take.set(to, m, take.at(from, m));
}

Take with_doubled(const Take& take, int frame, int times) {
  Take result = Take::empty(take.name, take.rate_hz, take.labels, take.frames() + times);
  for (int f = 0, to = 0; f < take.frames(); ++f) {
    for (int n = 0; n <= (f == frame ? times : 0); ++n, ++to) {
      for (int m = 0; m < take.markers(); ++m) result.set(to, m, take.at(f, m));
    }
  }
  return result;
}

TEST(Repeats, ACleanTakeHasNone) { EXPECT_TRUE(find_repeats(swaying(400)).empty()); }

TEST(Repeats, HeldFramesBecomeMissing) {
  Take take = swaying(400);
  for (int f = 121; f <= 123; ++f) copy_frame(take, 120, f);
  const auto found = find_repeats(take);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].kind, Repeat::Kind::held);
  EXPECT_EQ(found[0].first, 121);
  EXPECT_EQ(found[0].last, 123);
  const Take kept = without(take, found);
  ASSERT_EQ(kept.frames(), 400);
  EXPECT_TRUE(kept.has(120, 0));
  for (int f = 121; f <= 123; ++f) EXPECT_FALSE(kept.has(f, 7));
  EXPECT_TRUE(kept.has(124, 0));
}

TEST(Repeats, DoubledFramesAreTakenOut) {
  const Take take = swaying(400);
  for (const int times : {1, 2}) {
    const Take more = with_doubled(take, 120, times);
    const auto found = find_repeats(more);
    ASSERT_EQ(found.size(), 1U) << times;
    EXPECT_EQ(found[0].kind, Repeat::Kind::doubled) << times;
    EXPECT_EQ(without(more, found).positions, take.positions);
  }
}

TEST(Repeats, WithoutMotionFramesCountAsHeld) {
  Take take = swaying(400);
  Random random(5);
  for (int f = 100; f < 140; ++f) {  // at rest but for the noise
    for (int m = 0; m < 20; ++m) {
      const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
      take.set(f, m, take.at(100, m) + 0.1 * noise);
    }
  }
  copy_frame(take, 119, 120);
  const auto found = find_repeats(take);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].kind, Repeat::Kind::held);
}

TEST(Repeats, AMarkerThatStandsStillIsFound) {
  Take take = swaying(400);
  for (int f = 201; f < 212; ++f) take.set(f, 4, take.at(200, 4));
  const auto found = find_repeats(take);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].kind, Repeat::Kind::marker);
  EXPECT_EQ(found[0].marker, 4);
  EXPECT_EQ(found[0].first, 201);
  EXPECT_EQ(found[0].last, 211);
  const Take kept = without(take, found);
  EXPECT_FALSE(kept.has(205, 4));
  EXPECT_TRUE(kept.has(205, 5));
}

TEST(Repeats, RestLowerRatesAndRoundingAreNone) {
  Take rest = Take::empty("rest", 120.0, numbered("m", 5), 100);
  for (int f = 0; f < 100; ++f) {
    for (int m = 0; m < 5; ++m) rest.set(f, m, {10.0 * m, 1.0, 2.0});
  }
  EXPECT_TRUE(find_repeats(rest).empty());
  Take half = swaying(400);
  for (int f = 1; f < 400; f += 2) copy_frame(half, f - 1, f);
  EXPECT_TRUE(find_repeats(half).empty());
  Take coarse = swaying(2000);  // stored in steps of 0.5 mm, half of a frame's motion: repeats come by themselves
  for (float& value : coarse.positions) value = 0.5F * std::round(2.0F * value);
  EXPECT_TRUE(find_repeats(coarse).empty());
}

class RepeatsCleaned : public InFolder {};

TEST_F(RepeatsCleaned, AreFilledReportedAndReadBack) {
  Take take = swaying(400);
  for (int f = 121; f <= 123; ++f) copy_frame(take, 120, f);
  const Cleaned cleaned = clean(with_doubled(take, 250, 1), {});
  EXPECT_EQ(cleaned.take.frames(), 400);
  EXPECT_TRUE(cleaned.take.has(122, 3));
  EXPECT_NE(cleaned.report.origins[cleaned.take.index(122, 3)], Origin::measured);
  write_samples(folder / "samples.json", cleaned.report);
  const CleanReport read = read_samples(folder / "samples.json");
  ASSERT_EQ(read.repeats.size(), 2U);
  EXPECT_EQ(read.repeats[0].kind, Repeat::Kind::held);
  EXPECT_EQ(read.repeats[1].kind, Repeat::Kind::doubled);
  EXPECT_EQ(read.repeats[1].first, 251);
}

}  // namespace
}  // namespace vultus::mocap
