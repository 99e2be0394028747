#include <algorithm>
#include <numeric>

#include "core/error.h"
#include "mocap/layout_fit.h"
#include "mocap/template_labels.h"
#include "tests/unit/mocap/takes.h"

namespace vultus::mocap {
namespace {

constexpr int kMarkers = 40, kStrays = 2;

/// A face that opens its mouth and turns its head from `turn` radians on; 0.1 mm noise.
Take face(double turn, std::uint64_t seed) {
  const Points rest = face_markers(kMarkers);
  Take take = Take::empty("face", 60.0, numbered("f", kMarkers), 300);
  Random random(seed);
  for (int f = 0; f < take.frames(); ++f) {
    const double t = f / take.rate_hz;
    const Eigen::AngleAxisd rotation(turn + 0.3 * std::sin(1.5 * t), Eigen::Vector3d(0.3, 1, 0.2).normalized());
    for (int m = 0; m < kMarkers; ++m) {
      const Eigen::Vector3d p = rest.row(m);
      const Eigen::Vector3d open(0, p.y() < -20 ? 0.06 * p.y() * (1.0 - std::cos(2.0 * t)) : 0.0, 0);
      take.set(f, m, rotation * (p + open) + Eigen::Vector3d(500 * turn + 9 * t, 1200, 0) + jitter(random, 0.1));
    }
  }
  return take;
}

/// Without labels, columns shuffled, 8 % missing in bursts, two strays; `marker` says what each column is.
Take stripped(const Take& truth, std::vector<int>& marker) {
  marker.resize(kMarkers + kStrays);
  std::iota(marker.begin(), marker.end(), 0);
  Random random(17);
  for (std::size_t i = marker.size() - 1; i > 0; --i)
    std::swap(marker[i], marker[static_cast<std::size_t>(random.below(static_cast<int>(i) + 1))]);
  Take take = Take::empty("raw", truth.rate_hz, numbered("*", kMarkers + kStrays), truth.frames());
  for (int c = 0; c < take.markers(); ++c) {
    const int m = marker[static_cast<std::size_t>(c)];
    for (int f = 0; f < take.frames(); ++f) {
      const Eigen::Vector3d stray = truth.at(f, 3 * (m % kStrays)) + Eigen::Vector3d(25.0 + 0.1 * f, 0, 45);
      take.set(f, c, m < kMarkers ? truth.at(f, m) : stray);
    }
    for (int burst = 0; m < kMarkers && burst < 2; ++burst) {
      const int first = random.below(288);
      for (int f = first; f < first + 12; ++f) take.drop(f, c);
    }
  }
  return take;
}

/// Samples of labelled markers that stand where `truth` has them, and those that do not.
std::pair<int, int> right_and_wrong(const Take& labelled, const Take& truth) {
  std::pair<int, int> count{0, 0};
  for (int m = 0; m < truth.markers(); ++m) {
    const int c = labelled.find(truth.labels[static_cast<std::size_t>(m)]);
    for (int f = 0; c >= 0 && f < truth.frames(); ++f)
      if (labelled.has(f, c)) ++((labelled.at(f, c) - truth.at(f, m)).norm() < 1e-3 ? count.first : count.second);
  }
  return count;
}

TEST(TemplateLabels, StrippedTakeIsLabelledAgain) {
  const RigidBody layout = marker_layout(face(0.0, 3));
  const Take truth = face(2.0, 4);  // far round: nothing matches without alignment
  std::vector<int> marker;
  const Take raw = stripped(truth, marker);
  const Relabelled labelled = label_from_layout(raw, layout);
  const auto [right, wrong] = right_and_wrong(labelled.take, truth);
  int samples = 0;
  for (int c = 0; c < raw.markers(); ++c)
    for (int f = 0; f < raw.frames() && marker[static_cast<std::size_t>(c)] < kMarkers; ++f) samples += raw.has(f, c);
  EXPECT_GE(right, 0.99 * samples) << wrong << " wrong of " << samples;
  EXPECT_EQ(wrong, 0);  // strays are among what could be wrong
  const Take back = undo_edits(labelled.take, labelled.edits);
  EXPECT_EQ(back.labels, raw.labels);
  EXPECT_EQ(back.present, raw.present);
}

TEST(TemplateLabels, SwapsAndStraysAreFoundInTheSameRunAndUndone) {
  const Take truth = face(2.0, 4);
  std::vector<int> marker;
  Take raw = stripped(truth, marker);
  // Two columns whose markers change places for half a second, a column that holds a stray for as long.
  const auto column = [&](int m) {
    return static_cast<int>(std::find(marker.begin(), marker.end(), m) - marker.begin());
  };
  for (int f = 100; f < 130; ++f) {
    raw.set(f, column(5), truth.at(f, 13));
    raw.set(f, column(13), truth.at(f, 5));
    raw.set(f, column(21), truth.at(f, 21) + Eigen::Vector3d(0, 30, 40));
  }
  for (const int f : {99, 130})
    for (const int m : {5, 13, 21}) raw.set(f, column(m), truth.at(f, m));
  const Relabelled labelled = label_from_layout(raw, marker_layout(face(0.0, 3)));
  const auto [right, wrong] = right_and_wrong(labelled.take, truth);
  EXPECT_EQ(wrong, 0);
  EXPECT_GE(right, 0.9 * kMarkers * raw.frames());
  EXPECT_EQ(labelled.take.markers(), kMarkers);  // both strays are dropped
  const Take back = undo_edits(labelled.take, labelled.edits);
  ASSERT_EQ(back.present, raw.present);
  for (int f = 0; f < raw.frames(); ++f)
    for (int c = 0; c < raw.markers(); ++c)
      if (raw.has(f, c)) {
        ASSERT_EQ(back.at(f, c), raw.at(f, c));
      }
}

// A metre away it made every triple of the face look like a line.
TEST(TemplateLabels, AMarkerWrittenAsZeroIsNoPartOfTheLayout) {
  Take labelled = face(0.0, 3);
  for (int f = 0; f < labelled.frames(); ++f) labelled.set(f, 3, Eigen::Vector3d::Zero());
  const RigidBody layout = marker_layout(labelled);
  EXPECT_EQ(layout.labels.size(), kMarkers - 1U);
  const Take truth = face(2.0, 4);
  std::vector<int> marker;
  const auto [right, wrong] = right_and_wrong(label_from_layout(stripped(truth, marker), layout).take, truth);
  EXPECT_EQ(wrong, 0);
  EXPECT_GE(right, 0.88 * kMarkers * truth.frames());  // 39 of 40 markers, 8 % missing
}

TEST(TemplateLabels, LabelsThatAreThereStayAndHelp) {
  const Take truth = face(2.0, 4);
  std::vector<int> marker;
  Take raw = stripped(truth, marker);
  int labelled = 0;
  for (int c = 0; c < raw.markers(); ++c) {
    const int m = marker[static_cast<std::size_t>(c)];
    if (m >= kMarkers || m % 4 != 0) continue;
    raw.labels[static_cast<std::size_t>(c)] = truth.labels[static_cast<std::size_t>(m)];
    ++labelled;
  }
  ASSERT_EQ(labelled, 10);
  const Relabelled result = label_from_layout(raw, marker_layout(face(0.0, 3)));
  const auto [right, wrong] = right_and_wrong(result.take, truth);
  EXPECT_EQ(wrong, 0);
  EXPECT_GE(right, 0.9 * kMarkers * raw.frames());
}

/// Four rings of nine markers around the y axis, on a cone; one lies `off` mm beside its place.
Take round_layout(double off) {
  Take take = Take::empty("round", 60.0, numbered("r", 36), 60);
  for (int f = 0; f < 60; ++f) {
    for (int m = 0; m < 36; ++m) {
      const double angle = 2.0 * EIGEN_PI / 9.0 * (m % 9), height = 30.0 * (m / 9);
      Eigen::Vector3d p((100.0 - 0.5 * height) * std::cos(angle), height, (100.0 - 0.5 * height) * std::sin(angle));
      if (m % 9 == 0) p.y() += off;
      take.set(f, m, p + Eigen::Vector3d(0.1 * f, 0, 0));
    }
  }
  return take;
}

TEST(TemplateLabels, AFaceThatFitsTurnedRoundIsRefused) {
  const auto unlabelled = [](Take take) {
    take.labels = numbered("*", take.markers());
    return take;
  };
  // Turned by a ninth, every marker is on another: nothing tells which is which.
  EXPECT_THROW(label_from_layout(unlabelled(round_layout(0.0)), marker_layout(round_layout(0.0))), InputError);
  // Eleven millimetres at four of them do.
  const Relabelled told = label_from_layout(unlabelled(round_layout(11.0)), marker_layout(round_layout(11.0)));
  for (int m = 0; m < 36; ++m) {
    const int c = told.take.find("r" + std::to_string(m + 1));
    ASSERT_GE(c, 0) << m;
    EXPECT_EQ(told.take.at(30, c), round_layout(11.0).at(30, m));
  }
  // With six labels nothing needs to be told.
  Take some = unlabelled(round_layout(0.0));
  for (const int m : {0, 5, 11, 16, 22, 30}) some.labels[static_cast<std::size_t>(m)] = "r" + std::to_string(m + 1);
  const Relabelled helped = label_from_layout(some, marker_layout(round_layout(0.0)));
  for (int m = 0; m < 36; ++m) EXPECT_GE(helped.take.find("r" + std::to_string(m + 1)), 0);
}

TEST(TemplateLabels, OtherMarkersAreRefused) {
  const RigidBody layout = marker_layout(face(0.0, 3));
  Take other = Take::empty("other", 60.0, numbered("*", 30), 60);
  Random random(6);
  for (int m = 0; m < 30; ++m) {
    const Eigen::Vector3d p(random.uniform(-300, 300), random.uniform(-300, 300), random.uniform(-300, 300));
    for (int f = 0; f < 60; ++f) other.set(f, m, p);
  }
  EXPECT_THROW(label_from_layout(other, layout), InputError);
  EXPECT_THROW(marker_layout(other), InputError);
}

}  // namespace
}  // namespace vultus::mocap
