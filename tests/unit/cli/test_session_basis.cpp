#include <gtest/gtest.h>

#include "apps/session_basis.h"
#include "tests/unit/retarget/small_face.h"

namespace vultus::apps {
namespace {

using retarget::testing::SmallFace;

/// Between the markers of a 6×6 grid: closes a lid, so to speak.
void add_hidden_pose(rig::Actor& actor, const std::vector<SurfacePoint>& places) {
  rig::Pose hidden{"eyes_closed", {}, actor.neutral()};
  const Points markers = SmallFace::positions(actor, places, actor.neutral());
  for (Eigen::Index v = 0; v < hidden.positions.rows(); ++v) {
    const double nearest = (markers.rowwise() - hidden.positions.row(v)).rowwise().norm().minCoeff();
    if (nearest > 12.0) hidden.positions(v, 1) -= 8.0;
  }
  actor.poses.insert(actor.poses.begin() + 2, hidden);
}

/// Every pose but the hidden one held for half a second, the neutral between.
mocap::Take training_take(const rig::Actor& actor, const std::vector<SurfacePoint>& places) {
  const Points neutral = SmallFace::positions(actor, places, actor.neutral());
  std::vector<Points> frames(30, neutral);
  for (std::size_t i = 1; i < actor.poses.size(); ++i) {
    if (actor.poses[i].name == "eyes_closed") continue;
    const Points pose = SmallFace::positions(actor, places, actor.poses[i].positions);
    for (int f = 0; f < 90; ++f) {
      const double weight = std::clamp(f < 45 ? f / 15.0 : (75 - f) / 15.0, 0.0, 1.0);
      frames.push_back((1.0 - weight) * neutral + weight * pose);
    }
  }
  return SmallFace::take(SmallFace::labels(places.size()), frames);
}

TEST(TrainingPoses, WhatMovesNoMarkerIsLeftOutAndSaid) {
  rig::Actor actor = SmallFace::actor();
  const auto places = SmallFace::places(6);
  add_hidden_pose(actor, places);
  for (const auto& [label, at] : {std::pair{"M0", 0}, {"M5", 5}, {"M30", 30}, {"M35", 35}, {"M14", 14}})
    actor.markers[label] = places[static_cast<std::size_t>(at)];
  const SessionTake take{"training", "training.c3d", training_take(actor, places), {}};
  const TrainingPoses poses = training_poses(take, {}, actor);
  ASSERT_EQ(poses.poses, actor.pose_names());
  for (std::size_t i = 0; i < poses.poses.size(); ++i) {
    if (poses.poses[i] == "eyes_closed") {
      EXPECT_EQ(poses.captured[i].rows(), 0);
      continue;
    }
    ASSERT_EQ(poses.captured[i].rows(), 36) << poses.poses[i];
    const Points truth = SmallFace::positions(actor, places, actor.poses[i].positions);
    // Single precision of the samples, and the last frames of the way there.
    EXPECT_LT((poses.captured[i] - truth).rowwise().norm().maxCoeff(), 0.2) << poses.poses[i];
  }
  const auto said = [](const std::string& line) { return line.starts_with("training pose \"eyes_closed\" moves the markers by only 0.0 mm"); };
  EXPECT_EQ(std::ranges::count_if(poses.decisions, said), 1);
}

}  // namespace
}  // namespace vultus::apps
