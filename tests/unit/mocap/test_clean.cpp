#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files.h"
#include "mocap/clean.h"
#include "mocap/key_poses.h"
#include "tests/unit/mocap/takes.h"

namespace vultus::mocap {
namespace {

class Clean : public InFolder {};

/// Displacements of pose `k` (1…): a smooth field of its own.
Eigen::Vector3d pose_offset(int k, const Eigen::Vector3d& p) {
  return 6.0 *
         Eigen::Vector3d(std::sin(0.03 * k * p.y() + k), std::cos(0.02 * p.x() * k), 0.5 * std::sin(0.05 * p.x() + k));
}

/// A training take in head coordinates: rest 0.6 s, then pose 1 held 0.5 s, rest, pose 2 held, … moves of 0.3 s
/// between.
Take training_take(int poses, double noise) {
  const Points face = face_markers(20);
  const auto phase = [](int f) {  // which pose and how much of it
    const int cycle = 60 + 36 + 60 + 36, in = f % cycle;
    const double weight = in < 60 ? 0.0 : in < 96 ? (in - 60) / 36.0 : in < 156 ? 1.0 : 1.0 - (in - 156) / 36.0;
    return std::pair(f / cycle + 1, weight * weight * (3 - 2 * weight));
  };
  const int frames = poses * 192 + 60;
  Take take = Take::empty("training", 120.0, numbered("f", 20), frames);
  Random random(12);
  for (int f = 0; f < frames; ++f) {
    const auto [k, weight] = phase(f);
    for (int m = 0; m < 20; ++m) {
      const Eigen::Vector3d p = face.row(m);
      take.set(f, m, p + weight * pose_offset(k, p) + jitter(random, noise));
    }
  }
  return take;
}

void expect_pose(const KeyPoses& keys, std::size_t index, int k, double tolerance) {
  const Points face = face_markers(20);
  for (int m = 0; m < 20; ++m) {
    const Eigen::Vector3d p = face.row(m);
    const Eigen::Vector3d truth = k == 0 ? p : Eigen::Vector3d(p + pose_offset(k, p));
    EXPECT_LT((Eigen::Vector3d(keys.positions[index].row(m)) - truth).norm(), tolerance)
        << keys.poses[index] << " " << m;
  }
}

TEST_F(Clean, KeyPosesByHand) {
  Take take = training_take(3, 0.1);
  take.set(120, 5, {500, 500, 500});  // one wild sample in a hold must not matter
  for (int f = 490; f <= 530; ++f) take.drop(f, 7);
  const auto list = write(
      "training.json",
      R"({"take": "training", "poses": {"smile": [100, 150], "frown": 320, "neutral": [5, 50], "kiss": [490, 530]}})");
  const KeyPoses keys = key_poses(take, list);
  EXPECT_EQ(keys.poses, (std::vector<std::string>{"neutral", "frown", "kiss", "smile"}));
  expect_pose(keys, 0, 0, 0.15);  // 0.1 mm noise over some 25 frames
  expect_pose(keys, 1, 2, 0.25);  // one frame and its neighbours
  expect_pose(keys, 3, 1, 0.15);
  EXPECT_FALSE(keys.positions[2].row(7).allFinite());
  EXPECT_EQ(keys.decisions.size(), 1U);
  EXPECT_LT(keys.holds[1].first, 320);
  EXPECT_GT(keys.holds[1].second, 320);
}

TEST_F(Clean, KeyPosesFoundAutomatically) {
  const Take take = training_take(5, 0.1);
  const KeyPoses keys = find_key_poses(take, {"neutral", "p1", "p2", "p3", "p4", "p5"});
  ASSERT_EQ(keys.poses, (std::vector<std::string>{"neutral", "p1", "p2", "p3", "p4", "p5"}));
  for (int k = 0; k <= 5; ++k) {
    expect_pose(keys, static_cast<std::size_t>(k), k, 0.3);
    EXPECT_GT(keys.scores[static_cast<std::size_t>(k)], 0.4);
  }
  write_training(folder / "found.json", "training", keys);
  const KeyPoses again = key_poses(take, folder / "found.json");
  EXPECT_EQ(again.holds, keys.holds);
  EXPECT_THROW(find_key_poses(take, {"a", "b", "c", "d", "e", "f"}), InputError);
}

TEST_F(Clean, TrainingListIsChecked) {
  const Take take = training_take(1, 0.0);
  for (const char* text :
       {"[]", "{}", R"({"poses": {}})", R"({"poses": {"a": "x"}})", R"({"poses": {"a": [9, 3]}})",
        R"({"poses": {"a": 99999}})", R"({"poses": {"a": -1}})", R"({"poses": {"a": [1, 2, 3]}})", "{"}) {
    EXPECT_THROW(key_poses(take, write("bad.json", text)), InputError) << text;
  }
}

/// The training take on a moving head with a jig, with gaps, a spike and noise.
Take captured(Take* truth) {
  const Take face = training_take(2, 0.0);
  std::vector<std::string> labels = numbered("jig", 4);
  labels.insert(labels.end(), face.labels.begin(), face.labels.end());
  Take take = Take::empty("captured", 120.0, labels, face.frames());
  const Eigen::Vector3d jig[] = {{-70, 90, 20}, {70, 90, 20}, {0, 130, 10}, {20, 110, -40}};
  Random random(21);
  for (int f = 0; f < take.frames(); ++f) {
    const Eigen::AngleAxisd turn(0.25 * std::sin(0.02 * f), Eigen::Vector3d(0.2, 1, 0.1).normalized());
    const Eigen::Vector3d move(30 * std::sin(0.013 * f), 1500, 10);
    const auto put = [&](int m, const Eigen::Vector3d& p) { take.set(f, m, turn * p + move + jitter(random, 0.03)); };
    for (int j = 0; j < 4; ++j) put(j, jig[j]);
    for (int m = 0; m < 20; ++m) put(4 + m, face.at(f, m));
  }
  for (int f = 100; f < 110; ++f) take.drop(f, 9);
  for (int f = 200; f < 260; ++f) take.drop(f, 12);
  for (int f = 0; f < take.frames(); ++f) take.drop(f, 15);
  take.set(300, 10, take.at(300, 10) + Eigen::Vector3d(0, 9, 0));
  *truth = face;
  return take;
}

/// Splines and rigid groups: the regression has its own test, and takes its time.
CleanOptions plain_gaps() {
  CleanOptions options;
  options.gaps.method = GapMethod::rigid_group;
  options.gaps.trials = 40;
  return options;
}

TEST_F(Clean, ChainOnACapturedTake) {
  Take truth;
  const Take raw = captured(&truth);
  const Cleaned cleaned = clean(raw, plain_gaps());
  EXPECT_EQ(cleaned.take.labels, truth.labels);
  const CleanReport& report = cleaned.report;
  ASSERT_EQ(report.spikes.size(), 1U);
  EXPECT_EQ(report.spikes[0].first, 300);
  EXPECT_EQ(report.labels[static_cast<std::size_t>(report.spikes[0].marker)], "f7");
  EXPECT_EQ(report.origins[cleaned.take.index(105, 5)], Origin::spline);
  EXPECT_EQ(report.origins[cleaned.take.index(230, 8)], Origin::rigid_group);
  EXPECT_EQ(report.origins[cleaned.take.index(230, 11)], Origin::missing);
  EXPECT_DOUBLE_EQ(report.missing[11], 1.0);
  EXPECT_NEAR(report.head_rms, 0.03 * std::sqrt(3.0), 0.03);
  // The cleaned take is the truth seen in the reference frame's head, but for noise.
  Points now(20, 3), rest(20, 3);
  int rows = 0;
  for (int m = 0; m < 20; ++m) {
    if (m == 11) continue;
    now.row(rows) = cleaned.take.at(140, m);
    rest.row(rows++) = truth.at(140, m);
  }
  const Similarity head = fit_similarity(rest.topRows(rows), now.topRows(rows), Scaling::fixed);
  for (int f = 20; f < truth.frames() - 20; ++f) {
    for (int m = 0; m < 20; ++m) {
      if (m == 11 || (m == 8 && f >= 200 && f < 260)) continue;
      ASSERT_LT((cleaned.take.at(f, m) - head * truth.at(f, m)).norm(), 0.5) << f << " " << m;
    }
  }
}

TEST_F(Clean, SamplesFileKeepsTheReport) {
  Take truth;
  CleanReport report = clean(captured(&truth), plain_gaps()).report;
  report.warnings = {"labels: look here"};
  report.slips = {{"jig2", 120, 135, 2.5}, {"jig3", 300, -1, 4.0}};
  report.label_edits = {{LabelEdit::Kind::swap, {{10, 20, "f1", "f2"}, {10, 20, "f2", "f1"}}, 0.9, "near", true},
                        {LabelEdit::Kind::phantom, {{30, 34, "f3", ""}}, 0.5, "far", true}};
  write_samples(folder / "samples.json", report);
  const CleanReport read = read_samples(folder / "samples.json");
  EXPECT_EQ(read.take, report.take);
  EXPECT_EQ(read.labels, report.labels);
  EXPECT_EQ(read.origins, report.origins);
  EXPECT_EQ(read.decisions, report.decisions);
  EXPECT_EQ(read.warnings, report.warnings);
  EXPECT_EQ(read.head_markers, report.head_markers);
  ASSERT_EQ(read.gaps.size(), report.gaps.size());
  for (std::size_t i = 0; i < report.gaps.size(); ++i) {
    EXPECT_EQ(read.gaps[i].method, report.gaps[i].method);
    EXPECT_EQ(read.gaps[i].first, report.gaps[i].first);
    EXPECT_NEAR(read.gaps[i].expected_error, report.gaps[i].expected_error, 1e-3);
  }
  for (std::size_t i = 0; i < report.expected_errors.size(); ++i) {
    ASSERT_NEAR(read.expected_errors[i], report.expected_errors[i], 1e-3);
  }
  EXPECT_EQ(read.spikes.size(), report.spikes.size());
  ASSERT_EQ(read.slips.size(), 2U);
  EXPECT_EQ(read.slips[0].label, "jig2");
  EXPECT_EQ(read.slips[0].settled, 135);
  EXPECT_EQ(read.slips[1].settled, -1);
  ASSERT_EQ(read.label_edits.size(), 2U);
  EXPECT_EQ(read.label_edits[0].moves[1].to, "f1");
  EXPECT_EQ(read.label_edits[1].kind, LabelEdit::Kind::phantom);
  EXPECT_TRUE(read.label_edits[1].moves[0].to.empty());
}

TEST_F(Clean, TheReportListsEditsAndSlips) {
  Take truth;
  Take raw = captured(&truth);
  for (int f = 300; f < raw.frames(); ++f)
    raw.set(f, 1, raw.at(f, 1) + Eigen::Vector3d(0, 3, 0));  // a jig marker slips
  CleanOptions options = plain_gaps();
  options.label_edits.emplace();
  options.label_edits->edits = {{LabelEdit::Kind::phantom, {{40, 44, "f2", ""}}, 1.0, "by hand", true},
                                {LabelEdit::Kind::phantom, {{50, 54, "f2", ""}}, 1.0, "refused", false}};
  const CleanReport report = clean(raw, options).report;
  ASSERT_EQ(report.label_edits.size(), 2U);
  EXPECT_FALSE(report.label_edits[1].applied);
  for (const char* line : {"labels: 1 change made by the given list",
                           "labels: phantom at frame 50 refused in the list; the samples stay under f2"})
    EXPECT_TRUE(std::ranges::count(report.decisions, line)) << line;
  EXPECT_NE(report.origins[static_cast<std::size_t>(42) * report.labels.size() + 1], Origin::measured);
  EXPECT_EQ(report.origins[static_cast<std::size_t>(52) * report.labels.size() + 1], Origin::measured);
  ASSERT_FALSE(report.slips.empty());
  EXPECT_NEAR(report.slips[0].frame, 300, 2);
}

TEST_F(Clean, DamagedSamplesAreRefused) {
  Take truth;
  write_samples(folder / "samples.json", clean(captured(&truth), plain_gaps()).report);
  const std::string whole = bytes_of(folder / "samples.json");
  EXPECT_THROW(read_samples(write("a.json", "{}")), InputError);
  EXPECT_THROW(read_samples(write("b.json", whole.substr(0, whole.size() / 2))), InputError);
  std::string frames = whole;
  frames.replace(frames.find("\"frames\""), 8, "\"frame\"");
  EXPECT_THROW(read_samples(write("c.json", frames)), InputError);
  std::string origin = whole;
  origin.replace(origin.find("\"spline\""), 8, "\"spleen\"");
  EXPECT_THROW(read_samples(write("d.json", origin)), InputError);
  nlohmann::json gap = nlohmann::json::parse(whole), repeat = gap;
  for (auto& marker : gap["markers"])
    for (auto& each : marker["gaps"]) each["last"] = gap["frames"];
  EXPECT_THROW(read_samples(write("e.json", gap.dump())), InputError);
  repeat["repeats"] = {{{"what", "doubled"}, {"marker", ""}, {"first", 9}, {"last", 3}}};
  EXPECT_THROW(read_samples(write("f.json", repeat.dump())), InputError);
}

TEST_F(Clean, OptionsAreChecked) {
  Take truth;
  const Take raw = captured(&truth);
  CleanOptions options;
  options.gaps.trials = 3;
  EXPECT_THROW(clean(raw, options), UsageError);
  options = {};
  options.filter.cutoff_hz = -1.0;
  EXPECT_THROW(clean(raw, options), UsageError);
}

}  // namespace
}  // namespace vultus::mocap
