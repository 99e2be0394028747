#include <gtest/gtest.h>

#include "core/error.h"
#include "mocap/gap_methods.h"
#include "mocap/gaps.h"
#include "mocap/local_frames.h"
#include "tests/unit/mocap/takes.h"

namespace vultus::mocap {
namespace {

/// Thirty markers on two halves that rock against each other: each half is rigid.
Take rocking(int frames, double noise = 0.0) {
  const Points face = face_markers(30);
  Take take = Take::empty("rocking", 120.0, numbered("f", 30), frames);
  Random random(4);
  for (int f = 0; f < frames; ++f) {
    const double t = f / 120.0;
    const Eigen::AngleAxisd upper(0.05 * std::sin(3.0 * t), Eigen::Vector3d::UnitX());
    const Eigen::AngleAxisd lower(0.2 * std::sin(5.0 * t + 1.0), Eigen::Vector3d::UnitX());
    for (int m = 0; m < 30; ++m) {
      const Eigen::Vector3d p = face.row(m);
      const Eigen::Vector3d n(random.normal(), random.normal(), random.normal());
      take.set(f, m, (p.y() < 0 ? lower : upper) * p + noise * n);
    }
  }
  return take;
}

void hide(Take& take, int marker, int first, int last) {
  for (int f = first; f <= last; ++f) take.drop(f, marker);
}

TEST(Gaps, FoundByMarkerAndFrame) {
  Take take = Take::empty("t", 100.0, {"a", "b"}, 6);
  for (int f : {1, 2, 4}) take.set(f, 0, {1, 2, 3});
  const std::vector<Gap> gaps = find_gaps(take);
  ASSERT_EQ(gaps.size(), 4U);
  EXPECT_EQ(gaps[0].last, 0);
  EXPECT_EQ(gaps[1].first, 3);
  EXPECT_EQ(gaps[1].frames(), 1);
  EXPECT_EQ(gaps[3].marker, 1);
  EXPECT_EQ(gaps[3].frames(), 6);
}

TEST(Gaps, SplineIsExactForParabolasAndContinuous) {
  Take take = Take::empty("t", 100.0, {"a"}, 30);
  const auto path = [](double f) { return Eigen::Vector3d(0.02 * f * f, 3.0 - f, 5.0 + 0.5 * f - 0.01 * f * f); };
  for (int f = 0; f < 30; ++f) take.set(f, 0, path(f));
  const Gap gap{0, 12, 18};
  const auto filled = spline_fill({take, {{0, 12, 18}}}, gap);
  ASSERT_TRUE(filled);
  for (int f = 12; f <= 18; ++f) EXPECT_LT((filled->row(f - 12).transpose() - path(f)).norm(), 1e-5) << f;  // floats
}

TEST(Gaps, SplineAtAnEdgeHoldsAndWithoutSamplesGivesUp) {
  Take take = Take::empty("t", 100.0, {"a"}, 5);
  EXPECT_FALSE(spline_fill({take, {}}, {0, 0, 4}));
  take.set(4, 0, {7, 8, 9});
  const auto filled = spline_fill({take, {}}, {0, 0, 3});
  ASSERT_TRUE(filled);
  EXPECT_EQ(filled->row(1), Eigen::RowVector3d(7, 8, 9));
}

TEST(Gaps, RigidGroupIsExactForRigidMotion) {
  const Take take = rocking(400);
  const RigidGroups groups(take);
  int chin = 0;
  for (int m = 0; m < 30; ++m) {
    if (take.at(0, m).y() < take.at(0, chin).y()) chin = m;
  }
  const Gap gap{chin, 100, 220};
  const auto filled = rigid_group_fill({take, {{chin, 100, 220}}}, gap, groups, 6);
  ASSERT_TRUE(filled);
  for (int f = 100; f <= 220; ++f) {
    EXPECT_LT((filled->row(f - 100).transpose() - take.at(f, chin)).norm(), 1e-3) << f;  // floats of 100 mm, levered
  }
}

TEST(Gaps, RigidGroupNeedsThreeNeighbours) {
  Take take = rocking(100);
  const RigidGroups groups(take);
  for (int m = 3; m < 30; ++m) hide(take, m, 30, 60);
  EXPECT_FALSE(rigid_group_fill({take, {{0, 30, 60}}}, {0, 30, 60}, groups, 6));
}

TEST(Gaps, ShortBySplineLongByGroupAndTheRestStaysHoles) {
  Take take = rocking(600, 0.02);
  const Take truth = take;
  hide(take, 2, 100, 115);                               // 0.13 s
  hide(take, 5, 200, 320);                               // 1 s
  for (int m = 0; m < 30; ++m) hide(take, m, 500, 560);  // nobody is there
  FillOptions options;
  options.method = GapMethod::rigid_group;
  const Filled filled = fill_gaps(take, options);
  EXPECT_EQ(filled.origins[take.index(107, 2)], Origin::spline);
  EXPECT_EQ(filled.origins[take.index(260, 5)], Origin::rigid_group);
  EXPECT_EQ(filled.origins[take.index(530, 9)], Origin::missing);
  EXPECT_FALSE(filled.take.has(530, 9));
  EXPECT_EQ(filled.origins[take.index(50, 9)], Origin::measured);
  for (int f = 0; f < 600; ++f) {
    for (int m = 0; m < 30; ++m) {
      const std::size_t i = take.index(f, m);
      if (filled.origins[i] == Origin::measured) {
        ASSERT_EQ(filled.take.at(f, m), truth.at(f, m));
        ASSERT_EQ(filled.expected_errors[i], 0.0F);
      } else if (filled.origins[i] != Origin::missing) {
        ASSERT_GT(filled.expected_errors[i], 0.0F);
        ASSERT_LT((filled.take.at(f, m) - truth.at(f, m)).norm(), 0.8) << f << " " << m;
      }
    }
  }
}

TEST(Gaps, ExpectedErrorsCoverTheTruthAboutSevenTimesInTen) {
  Take take = rocking(1500, 0.05);
  const Take truth = take;
  Random random(17);
  for (int i = 0; i < 150; ++i) {
    const int m = random.below(30), length = 3 + random.below(60), first = 5 + random.below(1500 - length - 10);
    hide(take, m, first, first + length);
  }
  FillOptions options;
  options.method = GapMethod::rigid_group;
  const Filled filled = fill_gaps(take, options);
  int covered = 0, all = 0;
  for (std::size_t i = 0; i < filled.origins.size(); ++i) {
    if (filled.origins[i] == Origin::measured || filled.origins[i] == Origin::missing) continue;
    const int f = static_cast<int>(i) / 30, m = static_cast<int>(i) % 30;
    covered += (filled.take.at(f, m) - truth.at(f, m)).norm() <= filled.expected_errors[i];
    ++all;
  }
  ASSERT_GT(all, 2000);
  const double share = static_cast<double>(covered) / all;
  EXPECT_GT(share, 0.6);  // the figure that DESIGN asks for
  EXPECT_LT(share, 0.85);
}

TEST(Gaps, RegressionLearnsWhatNeitherSplineNorGroupKnows) {
  // The hidden marker follows two neighbours' motion by a law of its own, in the take but not rigid.
  Take take = Take::empty("law", 120.0, numbered("f", 8), 900);
  const Points face = face_markers(8);
  for (int f = 0; f < 900; ++f) {
    const double t = f / 120.0, a = std::sin(4.0 * t) + 0.5 * std::sin(9.1 * t), b = std::cos(5.3 * t);
    for (int m = 0; m < 8; ++m) {
      const Eigen::Vector3d own =
          m == 0 ? Eigen::Vector3d(2.0 * b, -3.0 * a, a + b) : Eigen::Vector3d(0, (m % 3) * a, (m % 2) * b);
      take.set(f, m, Eigen::Vector3d(face.row(m)) + own);
    }
  }
  const Take truth = take;
  hide(take, 0, 400, 520);
  FillOptions options;
  options.trials = 20;
  options.method = GapMethod::low_rank;
  const Filled learned = fill_gaps(take, options);
  options.method = GapMethod::rigid_group;
  options.hole_above_mm = 100.0;
  const Filled carried = fill_gaps(take, options);
  double learned_sum = 0.0, carried_sum = 0.0;
  for (int f = 400; f <= 520; ++f) {
    ASSERT_EQ(learned.origins[take.index(f, 0)], Origin::low_rank);
    learned_sum += (learned.take.at(f, 0) - truth.at(f, 0)).norm() / 121;
    carried_sum += (carried.take.at(f, 0) - truth.at(f, 0)).norm() / 121;
  }
  EXPECT_LT(learned_sum, 0.1);  // the law is linear, and the regression finds it to a few hundredths of its 3 mm
  EXPECT_GT(carried_sum, 5.0 * learned_sum);
}

TEST(Gaps, NeverCapturedMarkerStaysAHoleUnlessCarriedByItsSibling) {
  Take take = rocking(200);
  const Take truth = take;
  int lip = -1;
  for (int m = 0; m < 30; ++m) {
    if (take.at(0, m).y() < -50 && (lip < 0 || take.at(0, m).z() > take.at(0, lip).z())) lip = m;
  }
  Filled filled;
  filled.take = take;
  filled.origins.assign(take.present.size(), Origin::measured);
  filled.expected_errors.assign(take.present.size(), 0.0F);
  // A place 6 mm beside the lip marker, on the same rigid half.
  const Eigen::Vector3d offset(2.0, 5.0, -2.0);
  add_virtual_markers(filled, 10, {{"inner", truth.at(10, lip) + offset, take.labels[static_cast<std::size_t>(lip)]}});
  ASSERT_EQ(filled.take.find("inner"), 30);
  const auto turn = [](int f) {
    return Eigen::AngleAxisd(0.2 * std::sin(5.0 * f / 120.0 + 1.0), Eigen::Vector3d::UnitX());
  };
  for (int f = 0; f < 200; ++f) {
    ASSERT_TRUE(filled.take.has(f, 30));
    const Eigen::Vector3d expected = truth.at(f, lip) + turn(f) * (turn(10).inverse() * offset);
    // Exact while the four nearest markers are on the same half; a seam nearby may tilt the plane slightly.
    EXPECT_LT((filled.take.at(f, 30) - expected).norm(), 1.0) << f;
    EXPECT_EQ(filled.origins[filled.take.index(f, 30)], Origin::local_frame);
  }
  EXPECT_THROW(add_virtual_markers(filled, 10, {{"inner", {0, 0, 0}, ""}}), InputError);
}

TEST(Gaps, SameSeedSameBytes) {
  Take take = rocking(300, 0.05);
  hide(take, 3, 20, 90);
  hide(take, 4, 50, 60);
  FillOptions options;
  options.trials = 20;
  const Filled a = fill_gaps(take, options), b = fill_gaps(take, options);
  EXPECT_EQ(a.take.positions, b.take.positions);
  EXPECT_EQ(a.expected_errors, b.expected_errors);
}

}  // namespace
}  // namespace vultus::mocap
