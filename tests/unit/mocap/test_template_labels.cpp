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
      const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
      take.set(f, m, rotation * (p + open) + Eigen::Vector3d(500 * turn + 9 * t, 1200, 0) + 0.1 * noise);
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

TEST(TemplateLabels, StrippedTakeIsLabelledAgain) {
  const RigidBody layout = marker_layout(face(0.0, 3));
  const Take truth = face(2.0, 4);  // far round: nothing matches without alignment
  std::vector<int> marker;
  const Take raw = stripped(truth, marker);
  Relabelled labelled = label_from_layout(raw, layout);
  int right = 0, wrong = 0;
  for (int m = 0; m < kMarkers; ++m) {
    const int c = labelled.take.find("f" + std::to_string(m + 1));
    for (int f = 0; c >= 0 && f < raw.frames(); ++f)
      if (labelled.take.has(f, c)) ((labelled.take.at(f, c) - truth.at(f, m)).norm() < 1e-3 ? right : wrong) += 1;
  }
  int samples = 0;
  for (int c = 0; c < raw.markers(); ++c)
    for (int f = 0; f < raw.frames() && marker[static_cast<std::size_t>(c)] < kMarkers; ++f) samples += raw.has(f, c);
  RecordProperty("right", right);
  EXPECT_GE(right, 0.99 * samples) << wrong << " wrong of " << samples;
  EXPECT_EQ(wrong, 0);  // strays are among what could be wrong
  for (const LabelEdit& edit : labelled.edits.edits) EXPECT_GT(edit.score, 0.6);
  const Take back = undo_edits(labelled.take, labelled.edits);
  EXPECT_EQ(back.labels, raw.labels);
  EXPECT_EQ(back.present, raw.present);
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
