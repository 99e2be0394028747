#include <gtest/gtest.h>

#include <algorithm>

#include "mocap/frame_times.h"
#include "mocap/take_parts.h"
#include "mocap/trc.h"
#include "tests/unit/mocap/takes.h"

namespace vultus::mocap {
namespace {

/// A marker on a parabola, which cubic Hermite follows exactly inside: x = t², mm at t in hundredths of a second.
Take on_parabola(const std::vector<double>& times) {
  Take take = Take::empty("t", 100.0, {"a", "b"}, static_cast<int>(times.size()));
  for (int f = 0; f < take.frames(); ++f) {
    const double t = 100.0 * times[static_cast<std::size_t>(f)];
    take.set(f, 0, {t * t, t, 0.0});
    if (f != 20) take.set(f, 1, {0.0, t, 1.0});
  }
  return take;
}

std::vector<double> even(int n) {
  std::vector<double> times;
  for (int f = 0; f < n; ++f) times.push_back(0.01 * f);
  return times;
}

TEST(FrameTimes, EvenTimesChangeNothing) {
  std::vector<double> times = even(60);
  for (std::size_t f = 0; f < times.size(); f += 3) times[f] += 0.0004;  // as printed: within a tenth of a frame
  Take take = on_parabola(times);
  const Take before = take;
  to_even_times(take, times, 0.0);
  EXPECT_EQ(take.positions, before.positions);
  EXPECT_EQ(take.rate_hz, 100.0);
  EXPECT_TRUE(take.decisions.empty());
}

TEST(FrameTimes, FramesLeftOutComeBackAsMissing) {
  std::vector<double> times = even(60);
  times.erase(times.begin() + 30, times.begin() + 33);
  Take take = on_parabola(times);
  to_even_times(take, times, 0.0);
  ASSERT_EQ(take.frames(), 60);
  for (const int f : {30, 31, 32}) EXPECT_FALSE(take.has(f, 0)) << f;
  EXPECT_NEAR(take.at(33, 0).y(), 33.0, 1e-4);
  EXPECT_NEAR(take.at(59, 0).y(), 59.0, 1e-4);
  EXPECT_NE(take.decisions.back().find("3 frames left out"), std::string::npos) << take.decisions.back();
}

TEST(FrameTimes, AFrameGivenTwiceIsTakenOut) {
  std::vector<double> times = even(60);
  times.insert(times.begin() + 30, times[30]);
  Take take = on_parabola(times);
  to_even_times(take, times, 0.0);
  ASSERT_EQ(take.frames(), 60);
  for (int f = 0; f < 60; ++f) EXPECT_NEAR(take.at(f, 0).y(), f, 1e-4);
}

TEST(FrameTimes, ADriftingClockGivesItsOwnRate) {
  std::vector<double> times = even(200);
  for (double& t : times) t *= 1.002;
  Take take = on_parabola(times);
  to_even_times(take, times, 0.0);
  EXPECT_NEAR(take.rate_hz, 100.0 / 1.002, 1e-6);
  EXPECT_EQ(take.frames(), 200);
}

TEST(FrameTimes, AWanderingClockIsInterpolated) {
  std::vector<double> times = even(400);
  for (int f = 0; f < 400; ++f) times[static_cast<std::size_t>(f)] += 0.008 * std::sin(0.02 * f);  // up to 0.8 frames
  Take take = on_parabola(times);
  const Take read = take;
  to_even_times(take, times, 0.0);
  // The line through these times is not that of the true clock; on it, distances between frames are even again.
  const double step = take.at(200, 0).y() - take.at(199, 0).y();
  double worst = 0.0, worst_before = 0.0;
  for (int f = 40; f < 360; ++f) {
    worst = std::max(worst, std::abs(take.at(f + 1, 0).y() - take.at(f, 0).y() - step));
    worst_before = std::max(worst_before, std::abs(read.at(f + 1, 0).y() - read.at(f, 0).y() - 1.0));
  }
  EXPECT_GT(worst_before, 0.015);
  EXPECT_LT(worst, 0.003);  // samples within a tenth of a frame stay as read: a step of 0.016 of them at worst
  // The second marker lies beside the first, but for the one frame where it was not seen: no sample is made of it.
  int missing = 0;
  for (int f = 0; f < take.frames(); ++f) {
    ASSERT_TRUE(take.has(f, 0)) << f;
    missing += !take.has(f, 1);
    // Beside the hole the nearest sample stands, up to half a frame off.
    if (take.has(f, 1)) {
      EXPECT_NEAR(take.at(f, 1).y(), take.at(f, 0).y(), 0.5) << f;
    }
  }
  EXPECT_GE(missing, 1);
  EXPECT_LE(missing, 2);
}

TEST(FrameTimes, TimesThatFallAreReported) {
  std::vector<double> times = even(60);
  std::swap(times[20], times[40]);
  Take take = on_parabola(even(60));
  const Take before = take;
  to_even_times(take, times, 0.0);
  EXPECT_EQ(take.positions, before.positions);
  EXPECT_NE(take.decisions.back().find("do not rise"), std::string::npos);
}

/// Frames of `take` whose number in the file is `n`.
std::vector<int> frames_numbered(const Take& take, int n) {
  std::vector<int> frames;
  for (int f = 0; f < take.frames(); ++f)
    if (take.file_of_frame(f) == n) frames.push_back(f);
  return frames;
}

TEST(FrameTimes, EveryFrameKnowsItsNumberInTheFile) {
  std::vector<double> times = even(60);
  times.insert(times.begin() + 40, times[40]);          // one frame twice: the first is taken out
  times.erase(times.begin() + 30, times.begin() + 33);  // row 30 is frame 33, the two rows 37 and 38
  Take take = on_parabola(times);
  const Take read = take;
  to_even_times(take, times, 0.0);
  ASSERT_EQ(take.file_frames.size(), 60U);
  EXPECT_TRUE(std::is_sorted(take.file_frames.begin(), take.file_frames.end()));
  EXPECT_EQ(frames_numbered(take, 29), (std::vector<int>{29, 30, 31, 32}));  // and what the file lacks behind it
  EXPECT_EQ(frames_numbered(take, 30), (std::vector<int>{33}));
  for (int f = 0; f < 60; ++f) {
    if (!take.has(f, 0)) continue;
    EXPECT_EQ(take.at(f, 0), read.at(take.file_of_frame(f), 0)) << f;
  }
  for (int n = 0; n < read.frames(); ++n) {
    const int f = take.frame_of_file(n);  // never a frame that the file lacks
    EXPECT_EQ(take.at(f, 0), read.at(n == 37 ? 36 : n, 0)) << n;
  }
  EXPECT_EQ(take.frame_of_file(58), 59);
}

TEST(FrameTimes, FramesTakenOutLaterKeepTheNumbersOfTheFile) {
  std::vector<double> times = even(60);
  times.erase(times.begin() + 30, times.begin() + 33);
  Take take = on_parabola(times);
  to_even_times(take, times, 0.0);
  std::vector<std::uint8_t> keep(60, 1);
  keep[50] = 0;
  keep_frames(keep, take);
  EXPECT_EQ(take.file_of_frame(49), 46);
  EXPECT_EQ(take.file_of_frame(50), 48);
  EXPECT_EQ(take.frame_of_file(48), 50);
}

class FrameTimesFile : public InFolder {};

TEST_F(FrameTimesFile, OfATrcAreUsed) {
  write_trc(folder / "a.trc", on_parabola(even(30)));
  std::string text = bytes_of(folder / "a.trc");
  text.erase(text.find("\n11\t") + 1, text.find("\n13\t") - text.find("\n11\t"));  // two rows lost
  text.replace(text.find("\t30\t2\tmm"), 4, "\t28\t");
  const Take take = read_trc(write("b.trc", text));
  ASSERT_EQ(take.frames(), 30);
  EXPECT_FALSE(take.has(10, 0));
  EXPECT_FALSE(take.has(11, 0));
  EXPECT_FLOAT_EQ(static_cast<float>(take.at(29, 0).y()), 29.0F);
  EXPECT_EQ(take.file_of_frame(29), 27);  // two rows fewer
}

}  // namespace
}  // namespace vultus::mocap
