#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.h"
#include "mocap/clean.h"
#include "mocap/key_poses.h"
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
      take.set(f, m, face.row(m).transpose() + Eigen::Vector3d(12.0 * std::sin(0.026 * f), 0, 0) + jitter(random, 0.1));
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
      take.set(f, m, take.at(100, m) + jitter(random, 0.1));
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

TEST(Repeats, AMarkerFrozenToTheEndIsADropout) {
  for (const int from : {380, 250, 1}) {  // for a moment, for a third, throughout
    Take take = swaying(400);
    for (int f = from; f < 400; ++f) take.set(f, 4, take.at(from - 1, 4));
    const auto found = find_repeats(take);
    ASSERT_EQ(found.size(), 1U) << from;
    EXPECT_EQ(found[0].kind, Repeat::Kind::marker);
    EXPECT_EQ(found[0].marker, 4);
    EXPECT_EQ(found[0].first, from);
    EXPECT_EQ(found[0].last, 399);
  }
  Take rest = swaying(400);  // all of them at rest, to the bit: no dropout of one
  for (int f = 250; f < 400; ++f) copy_frame(rest, 249, f);
  for (const Repeat& repeat : find_repeats(rest)) EXPECT_NE(repeat.kind, Repeat::Kind::marker);
}

TEST(Repeats, ARecordingThatStallsIsHeld) {
  Take take = swaying(400);
  for (int f = 250; f < 400; ++f) copy_frame(take, 249, f);  // more than a third of the take
  const auto found = find_repeats(take);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].kind, Repeat::Kind::held);
  EXPECT_EQ(found[0].first, 250);
}

TEST(Repeats, HalfTheRateIsReported) {
  for (const int times : {2, 3}) {
    Take slow = swaying(600);
    for (int f = 0; f < 600; ++f) copy_frame(slow, f - f % times, f);
    const auto found = find_repeats(slow);
    ASSERT_EQ(found.size(), 1U) << times;
    EXPECT_EQ(found[0].kind, Repeat::Kind::lower_rate);
    EXPECT_EQ(found[0].times, times);
    EXPECT_EQ(without(slow, found).present, slow.present);
  }
}

TEST(Repeats, RestAndRoundingAreNone) {
  Take rest = Take::empty("rest", 120.0, numbered("m", 5), 100);
  for (int f = 0; f < 100; ++f) {
    for (int m = 0; m < 5; ++m) rest.set(f, m, {10.0 * m, 1.0, 2.0});
  }
  EXPECT_TRUE(find_repeats(rest).empty());
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
  EXPECT_EQ(read.file_frames, cleaned.report.file_frames);
}

TEST_F(RepeatsCleaned, FramesOfATrainingListAreTheFiles) {
  Take take = swaying(400);
  for (int f = 290; f < 310; ++f)  // a pose: marker 3 out by 10 mm
    for (int m = 0; m < 20; ++m) take.set(f, m, take.at(290, m) + Eigen::Vector3d(0, m == 3 ? 10.0 : 0.0, 1e-3 * f));
  const Cleaned cleaned = clean(with_doubled(take, 250, 5), {});
  ASSERT_EQ(cleaned.take.frames(), 400);
  EXPECT_EQ(cleaned.take.frame_of_file(250), 250);
  EXPECT_EQ(cleaned.take.frame_of_file(253), 250);  // taken out: the frame that it repeats
  EXPECT_EQ(cleaned.take.frame_of_file(256), 251);
  EXPECT_EQ(cleaned.take.frame_of_file(404), 399);
  const auto list = write("training.json", R"({"take": "t", "poses": {"up": [299, 310], "rest": 100, "last": 404}})");
  const KeyPoses poses = key_poses(cleaned.take, list);
  const auto up = std::find(poses.poses.begin(), poses.poses.end(), "up") - poses.poses.begin();
  EXPECT_EQ(poses.holds[static_cast<std::size_t>(up)], std::make_pair(294, 305));
  write_training(folder / "again.json", "t", poses);
  EXPECT_EQ(key_poses(cleaned.take, folder / "again.json").holds, poses.holds);
  EXPECT_THROW(key_poses(cleaned.take, write("off.json", R"({"poses": {"up": 405}})")), InputError);
}

TEST_F(RepeatsCleaned, ALowerRateIsSaid) {
  Take slow = swaying(400);
  for (int f = 1; f < 400; f += 2) copy_frame(slow, f - 1, f);
  const CleanReport report = clean(slow, {}).report;
  ASSERT_EQ(report.repeats.size(), 1U);
  EXPECT_EQ(report.repeats[0].kind, Repeat::Kind::lower_rate);
  const auto said = [](const std::string& line) { return line.find("recorded at 60 Hz, not at 120") != line.npos; };
  EXPECT_TRUE(std::any_of(report.decisions.begin(), report.decisions.end(), said));
}

}  // namespace
}  // namespace vultus::mocap
