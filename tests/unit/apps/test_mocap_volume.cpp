#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "apps/virtual_stage/actor.h"
#include "apps/virtual_stage/expressions.h"
#include "apps/virtual_stage/mocap_volume.h"
#include "core/error.h"
#include "register/template_head.h"

namespace vultus::virtual_stage {
namespace {

const FaceModel& actor() {
  static const registration::Template head = registration::template_head();
  static const FaceModel face(head, identity(head, 11));
  return face;
}
const MarkerLayout& layout() {
  static const MarkerLayout made = marker_layout(actor(), 3);
  return made;
}

Performance short_take() {
  Performance p = perform("emotions", 3.0, 40.0, 5);  // few frames keep the test fast
  return p;
}

TEST(MarkerLayout, CountsAndNames) {
  EXPECT_EQ(layout().labels.size(), 97u);
  EXPECT_EQ(layout().jig.rows(), 5);
  std::set<std::string> labels(layout().labels.begin(), layout().labels.end());
  labels.insert(layout().jig_labels.begin(), layout().jig_labels.end());
  EXPECT_EQ(labels.size(), 102u);
  EXPECT_EQ(std::ranges::count_if(layout().labels, [](const std::string& l) { return l[0] == 'L'; }), 42);
  EXPECT_EQ(std::ranges::count_if(layout().labels, [](const std::string& l) { return l[0] == 'R'; }), 42);
}

TEST(MarkerLayout, SidesAreTheSubjectsAndMarkersKeepApart) {
  const Points at = marker_positions(layout(), *actor().topology(), actor().neutral());
  for (std::size_t m = 0; m < layout().labels.size(); ++m) {
    const double side = layout().labels[m][0] == 'L' ? 1 : layout().labels[m][0] == 'R' ? -1 : 0;
    if (side != 0) {
      EXPECT_GT(side * at(m, 0), 1.5) << layout().labels[m];
    }
    for (std::size_t other = 0; other < m; ++other)
      EXPECT_GT((at.row(m) - at.row(other)).norm(), 2 * marker_radius) << layout().labels[m] << layout().labels[other];
  }
}

TEST(MarkerLayout, NoneOnLidsOrInsideTheMouth) {
  const Topology& topology = *actor().topology();
  for (const char* set : {"lids", "inner_mouth", "eyeballs", "neck", "back_of_head"}) {
    std::vector<bool> in(topology.vertex_count(), false);
    for (const int v : topology.set(set)) in[v] = true;
    for (std::size_t m = 0; m < layout().places.size(); ++m) {
      const auto corners = topology.triangles().row(layout().places[m].triangle);
      EXPECT_FALSE(in[corners[0]] && in[corners[1]] && in[corners[2]]) << layout().labels[m] << " " << set;
    }
  }
}

TEST(MarkerLayout, AnchorsSitOnTheirLandmarks) {
  EXPECT_GE(layout().anchors.size(), 12u);
  EXPECT_LE(layout().anchors.size(), 14u);
  const Points at = marker_positions(layout(), *actor().topology(), actor().neutral());
  for (const auto& [label, landmark] : layout().anchors) {
    const auto m = std::ranges::find(layout().labels, label) - layout().labels.begin();
    const Eigen::RowVector3d on = actor().neutral().row(actor().topology()->landmarks().at(landmark));
    EXPECT_NEAR((at.row(m) - on).norm(), marker_radius, 1e-6) << label;
  }
}

TEST(Volume, NoiseIsWhatWasAsked) {
  VolumeOptions options;
  options.missing = 0;
  const RecordedTake recorded = record(actor(), layout(), short_take(), options);
  double sum = 0;
  int count = 0;
  for (int f = 0; f < recorded.take.frames(); ++f)
    for (int m = 0; m < recorded.take.markers(); ++m) {
      sum += (recorded.take.at(f, m) - recorded.volume_from_face[f] * recorded.clean.at(f, m)).squaredNorm();
      count += 3;
    }
  // 36,000 numbers: 0.4 % for one standard deviation of the estimate; four of them.
  EXPECT_NEAR(std::sqrt(sum / count), options.noise, 0.016 * options.noise);
}

TEST(Volume, HeadMotionIsRigidForTheJig) {
  VolumeOptions options;
  options.noise = 0;
  options.missing = 0;
  const RecordedTake recorded = record(actor(), layout(), short_take(), options);
  const int first = recorded.take.find("JIG1");
  double turned = 0;
  for (int f = 0; f < recorded.take.frames(); ++f) {
    for (int j = 0; j < 5; ++j)
      for (int k = 0; k < j; ++k)
        EXPECT_NEAR((recorded.take.at(f, first + j) - recorded.take.at(f, first + k)).norm(),
                    (layout().jig.row(j) - layout().jig.row(k)).norm(), 1e-3);  // float positions a metre away
    turned = std::max(turned, (recorded.volume_from_face[f].rotation - recorded.volume_from_face[0].rotation).norm());
  }
  EXPECT_GT(turned, 0.05);
  EXPECT_GT(recorded.take.at(0, 0).y(), 1000);  // the actor sits in a room, +y up
}

TEST(Volume, GapsComeAtTheAskedRateInBursts) {
  VolumeOptions options;
  options.missing = 0.05;
  const RecordedTake recorded = record(actor(), layout(), short_take(), options);
  const int face = static_cast<int>(layout().labels.size());
  EXPECT_NEAR(missing_share(recorded.take, 0, face), 0.05, 1e-4);
  EXPECT_NEAR(missing_share(recorded.take, face, face + 5), 0.005, 1e-3);
  EXPECT_EQ(missing_share(recorded.clean, 0, face + 5), 0.0);
  int gaps = 0, missing = 0;
  for (int m = 0; m < face; ++m)
    for (int f = 0; f < recorded.take.frames(); ++f) {
      missing += !recorded.take.has(f, m);
      gaps += !recorded.take.has(f, m) && (f == 0 || recorded.take.has(f - 1, m));
    }
  EXPECT_GT(missing, 4 * gaps);
}

TEST(Volume, SameBytesForAnyThreadCount) {
  const RecordedTake many = record(actor(), layout(), short_take(), {});
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const RecordedTake one = record(actor(), layout(), short_take(), {});
  EXPECT_EQ(many.take.positions, one.take.positions);
  EXPECT_EQ(many.take.present, one.take.present);
}

TEST(Volume, RefusesNonsense) {
  VolumeOptions options;
  options.missing = 0.9;
  EXPECT_THROW(record(actor(), layout(), short_take(), options), UsageError);
}

TEST(Training, ShowsEveryPoseInOrder) {
  std::vector<std::string> names;
  for (const Expression& e : expression_database()) names.push_back(e.name);
  const TrainingSession session = training_session(names, 0.5, 60.0, 1);
  ASSERT_EQ(session.holds.size(), names.size());
  int before = -1;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Hold& hold = session.holds[i];
    EXPECT_EQ(hold.pose, names[i]);
    EXPECT_GT(hold.first, before);
    EXPECT_GE(hold.last - hold.first, 25);
    ASSERT_LT(hold.last, static_cast<int>(session.performance.frames.size()));
    before = hold.last;
    const Activations target = expression(names[i]).activations;
    for (const int f : {hold.first, hold.last})
      // Effort within 8 %, lean within 4 %, sway 1.5 %.
      EXPECT_LT((session.performance.frames[f] - target).cwiseAbs().maxCoeff(),
                0.14 * target.cwiseAbs().maxCoeff() + 1e-9);
  }
  EXPECT_EQ(session.performance.frames.front().cwiseAbs().maxCoeff(), 0.0);
}

TEST(Performances, AreAsymmetricAndSmooth) {
  for (const std::string& name : performance_names()) {
    const Performance p = perform(name, 8.0, 120.0, 1);
    ASSERT_EQ(p.frames.size(), 960u);
    double lean = 0, jump = 0;
    for (std::size_t f = 0; f < p.frames.size(); ++f) {
      for (int m = 0; m < muscle_count; ++m)
        lean = std::max(lean, std::abs(p.frames[f][2 * m] - p.frames[f][2 * m + 1]));
      if (f > 0) jump = std::max(jump, (p.frames[f] - p.frames[f - 1]).cwiseAbs().maxCoeff());
    }
    EXPECT_GT(lean, 0.6) << name;
    EXPECT_LT(jump, 0.25) << name;  // a blink closes in 90 ms, 11 frames, fastest in its middle
  }
  EXPECT_THROW(perform("speach", 8, 120, 1), InputError);
}

}  // namespace
}  // namespace vultus::virtual_stage
