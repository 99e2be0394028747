#include <algorithm>

#include "core/error.h"
#include "mocap/assignment.h"
#include "mocap/label_doubts.h"
#include "mocap/labels.h"
#include "mocap/tracklets.h"
#include "tests/unit/mocap/takes.h"

namespace vultus::mocap {
namespace {

/// 24 markers of a face that breathes and turns its head, 6 s at 60 Hz.
Take moving_face() {
  const Points rest = face_markers(24);
  Take take = Take::empty("face", 60.0, numbered("f", 24), 360);
  Random random(3);
  for (int f = 0; f < take.frames(); ++f) {
    const double t = f / take.rate_hz;
    const Eigen::AngleAxisd turn(0.2 * std::sin(1.5 * t), Eigen::Vector3d::UnitY());
    for (int m = 0; m < take.markers(); ++m) {
      const Eigen::Vector3d p = rest.row(m);
      const Eigen::Vector3d open(0, p.y() < 0 ? 0.05 * p.y() * (1.0 + std::sin(2.0 * t)) : 0.0, 0);
      take.set(f, m, turn * (p + open) + Eigen::Vector3d(5 * t, 1200, 0) + jitter(random, 0.1));
    }
  }
  return take;
}

/// Exchanges two columns over frames.
void exchange(Take& take, int a, int b, int first, int last) {
  for (int f = first; f <= last; ++f) {
    const Eigen::Vector3d at_a = take.at(f, a), at_b = take.at(f, b);
    take.set(f, a, at_b);
    take.set(f, b, at_a);
  }
}

/// The marker whose rest place is nearest to that of `m`.
int nearest_to(int m) {
  const Points rest = face_markers(24);
  Eigen::VectorXd distances = (rest.rowwise() - rest.row(m)).rowwise().norm();
  distances[m] = 1e9;
  int nearest = 0;
  distances.minCoeff(&nearest);
  return nearest;
}

bool same_samples(const Take& a, const Take& b) {
  if (a.labels != b.labels || a.present != b.present) return false;
  for (std::size_t i = 0; i < a.present.size(); ++i) {
    if (a.present[i] && !std::equal(&a.positions[3 * i], &a.positions[3 * i] + 3, &b.positions[3 * i])) return false;
  }
  return true;
}

TEST(Assignment, ByHand) {
  Eigen::MatrixXd cost(2, 3);
  cost << 1, 2, 9,  //
      1, 5, 9;      // both want the first; together 2 + 1 is least
  EXPECT_EQ(least_cost_assignment(cost), (std::vector<int>{1, 0}));
  EXPECT_THROW(least_cost_assignment(cost.transpose()), UsageError);
}

TEST(Assignment, NoOtherIsCheaper) {
  Random random(5);
  for (int trial = 0; trial < 20; ++trial) {
    Eigen::MatrixXd cost(5, 6);
    for (double& value : cost.reshaped()) value = random.uniform();
    const std::vector<int> given = least_cost_assignment(cost);
    double sum = 0.0, least = 1e9;
    for (int r = 0; r < 5; ++r) sum += cost(r, given[static_cast<std::size_t>(r)]);
    std::vector<int> order = {0, 1, 2, 3, 4, 5};
    do {
      double other = 0.0;
      for (int r = 0; r < 5; ++r) other += cost(r, order[static_cast<std::size_t>(r)]);
      least = std::min(least, other);
    } while (std::next_permutation(order.begin(), order.end()));
    EXPECT_NEAR(sum, least, 1e-12);
  }
}

TEST(Tracklets, AreCutAtGapsAndJumps) {
  Take take = Take::empty("line", 100.0, {"a"}, 20);
  for (int f = 0; f < 20; ++f) take.set(f, 0, {0.5 * f + (f >= 12 ? 9.0 : 0.0), 0, 0});
  take.drop(5, 0);
  const std::vector<Tracklet> cut = cut_tracklets(take, 1.5);
  ASSERT_EQ(cut.size(), 3U);
  EXPECT_EQ(cut[0].last, 4);
  EXPECT_EQ(cut[1].first, 6);
  EXPECT_EQ(cut[1].last, 11);
  EXPECT_EQ(cut[2].first, 12);
}

TEST(Tracklets, UnlabelledNames) {
  for (const char* name : {"*12", "", "Unlabeled 1003", "subject:U_4", "point_7"})
    EXPECT_TRUE(is_unlabelled(name)) << name;
  for (const char* name : {"LBRO1", "uplip", "pointer", "C7", "m1"}) EXPECT_FALSE(is_unlabelled(name)) << name;
}

TEST(Labels, WhatIsRightStays) {
  Take take = moving_face();
  Random random(8);
  for (int burst = 0; burst < 40; ++burst) {
    const int m = random.below(24), first = random.below(340);
    for (int f = first; f < first + 12; ++f) take.drop(f, m);
  }
  const Relabelled repaired = repair_labels(take);
  EXPECT_TRUE(repaired.edits.edits.empty());
  EXPECT_TRUE(same_samples(repaired.take, take));
}

TEST(Labels, SwapIsFoundAndListed) {
  const Take truth = moving_face();
  Take take = truth;
  const int a = 9, b = nearest_to(a);
  exchange(take, a, b, 100, 160);
  const Relabelled repaired = repair_labels(take);
  EXPECT_TRUE(same_samples(repaired.take, truth));
  ASSERT_EQ(repaired.edits.edits.size(), 1U);
  const LabelEdit& edit = repaired.edits.edits[0];
  EXPECT_EQ(edit.kind, LabelEdit::Kind::swap);
  EXPECT_EQ(edit.first(), 100);
  EXPECT_EQ(edit.last(), 160);
  EXPECT_GT(edit.score, 0.8);
}

TEST(Labels, FragmentsComeHomeAndPhantomsGo) {
  const Take truth = moving_face();
  std::vector<std::string> labels = truth.labels;
  labels.insert(labels.end(), {"*1", "*2"});
  Take take = Take::empty("face", truth.rate_hz, labels, truth.frames());
  for (int f = 0; f < truth.frames(); ++f) {
    for (int m = 0; m < truth.markers(); ++m) {
      const bool fragment = m == 4 && f >= 50 && f < 110;
      take.set(f, fragment ? 24 : m, truth.at(f, m));
    }
    if (f >= 200 && f < 240) take.set(f, 25, truth.at(f, 7) + Eigen::Vector3d(9, 3, 4));
  }
  const Relabelled repaired = repair_labels(take);
  EXPECT_TRUE(same_samples(repaired.take, truth));
  ASSERT_EQ(repaired.edits.edits.size(), 2U);
  EXPECT_EQ(repaired.edits.edits[0].kind, LabelEdit::Kind::fragment);
  EXPECT_EQ(repaired.edits.edits[1].kind, LabelEdit::Kind::phantom);
  EXPECT_EQ(repaired.edits.dropped.size(), 40U);
}

// One marker a metre away in every frame that could be the reference made all triples of the face look like lines.
TEST(Labels, AMarkerWrittenAsZeroDoesNotHideTheFace) {
  Take take = moving_face();
  for (int f = 0; f < take.frames(); ++f) take.set(f, 3, Eigen::Vector3d::Zero());
  const int a = 9, b = nearest_to(a);
  exchange(take, a, b, 100, 160);
  const Relabelled repaired = repair_labels(take);
  const Take truth = moving_face();
  for (int f = 100; f <= 160; ++f) ASSERT_EQ(repaired.take.at(f, a), truth.at(f, a)) << f;
}

/// The tracklets' own labels: what a repair starts from.
std::vector<int> borne(const LabelEvidence& evidence) {
  std::vector<int> labels;
  for (const LabelledTracklet& t : evidence.tracklets()) labels.push_back(t.label);
  return labels;
}

TEST(LabelDoubts, ASwapThatIsLeftShowsAtItsEnds) {
  Take take = moving_face();
  const LabelEvidence good(take, LabelOptions().jump_mm);
  EXPECT_TRUE(label_doubts(good, borne(good)).empty());
  const int a = 9, b = nearest_to(a);
  exchange(take, a, b, 100, 220);
  for (int f = 94; f < 100; ++f) take.drop(f, a);  // the one comes back from an absence
  const LabelEvidence evidence(take, LabelOptions().jump_mm);
  const std::vector<std::string> doubts = label_doubts(evidence, borne(evidence));
  ASSERT_EQ(doubts.size(), 1U);
  EXPECT_EQ(std::ranges::count(doubts[0], '/'), 2) << doubts[0];  // two ends, two labels each
  for (const int frame : {100, 221})
    EXPECT_NE(doubts[0].find("at frame " + std::to_string(frame)), std::string::npos) << doubts[0];
}

TEST(LabelDoubts, HalfASwapAndManyFaultsAreTold) {
  Take take = moving_face();
  const int a = 9, b = nearest_to(a);
  exchange(take, a, b, 100, 220);
  LabelEvidence evidence(take, LabelOptions().jump_mm);
  const std::vector<int> original = borne(evidence);
  // What came under b goes to a, and what came under a is dropped.
  for (LabelledTracklet& t : evidence.tracklets()) {
    if (t.span.first == 100 && t.span.column == b) t.label = a;
    if (t.span.first == 100 && t.span.column == a) t.label = -1;
  }
  const std::vector<std::string> doubts = label_doubts(evidence, original);
  ASSERT_EQ(doubts.size(), 2U);
  EXPECT_NE(doubts[0].find("half of a swap: f" + std::to_string(a + 1) + " in frames 100 to 220"), std::string::npos)
      << doubts[0];
  EXPECT_NE(doubts[1].find("2.8 %"), std::string::npos) << doubts[1];  // 2 × 121 of 24 × 360
}

class LabelFiles : public InFolder {};

TEST_F(LabelFiles, EveryChangeIsTakenBack) {
  Take take = moving_face();
  take.residuals.assign(take.present.size(), 0.0F);
  for (std::size_t i = 0; i < take.residuals.size(); ++i) take.residuals[i] = 0.01F * static_cast<float>(i % 7);
  exchange(take, 9, nearest_to(9), 100, 160);
  for (int f = 250; f < 290; ++f) take.set(f, 3, take.at(f, 3) + Eigen::Vector3d(12, 8, 9));
  Relabelled repaired = repair_labels(take);
  ASSERT_EQ(repaired.edits.edits.size(), 2U);
  write_edits(folder / "labels.json", repaired.edits);
  LabelEdits read = read_edits(folder / "labels.json");
  const Take back = undo_edits(repaired.take, read);
  EXPECT_TRUE(same_samples(back, take));
  EXPECT_EQ(back.residuals, take.residuals);
  EXPECT_TRUE(same_samples(apply_edits(back, read), repaired.take));
  for (LabelEdit& edit : read.edits) edit.applied = false;
  EXPECT_TRUE(same_samples(apply_edits(take, read), take));
}

TEST_F(LabelFiles, BadListsAreRefused) {
  const Take take = moving_face();
  EXPECT_THROW(read_edits(write("a.json", R"({"edits": [{"kind": "shuffle", "moves": []}]})")), InputError);
  EXPECT_THROW(read_edits(write("b.json", R"({"edits": [{"kind": "swap", "moves": [{"frames": [1]}]}]})")), InputError);
  LabelEdits edits;
  edits.edits.push_back({LabelEdit::Kind::moved, {{0, 5, "f1", "f2"}}, 1.0, "", true});
  EXPECT_THROW(apply_edits(take, edits), InputError);  // f2 is there already
  edits.edits[0].moves = {{0, 5, "nobody", "f2"}};
  EXPECT_THROW(apply_edits(take, edits), InputError);
  edits.edits[0].moves = {{0, 500, "f1", ""}};
  EXPECT_THROW(apply_edits(take, edits), InputError);
}

TEST(LabelsReal, NothingIsRepairedInCleanTakes) {
  if (real_data().empty()) GTEST_SKIP() << "no real data";
  for (const char* file :
       {"animface-markers/Eyebrows.c3d", "animface-markers/Jaw.c3d", "blenderface-markers/Subject_01.csv"}) {
    const Relabelled repaired = repair_labels(read_take(real_data() / file));
    EXPECT_TRUE(repaired.edits.edits.empty()) << file;
    EXPECT_TRUE(repaired.warnings.empty()) << file;
  }
}

}  // namespace
}  // namespace vultus::mocap
