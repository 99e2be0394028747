#include "retarget/marker_basis.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "small_face.h"

namespace vultus::retarget {
namespace {

using testing::SmallFace;

struct Training {
  rig::Actor actor = SmallFace::actor();
  std::vector<SurfacePoint> places = SmallFace::places(7);
  std::vector<std::string> labels = SmallFace::labels(places.size());
  std::vector<Points> captured;

  Training() {
    for (const rig::Pose& pose : actor.poses) {
      captured.push_back(SmallFace::positions(actor, places, pose.positions));
    }
  }
};

TEST(MarkerBasis, TrainingOnTheRigsOwnFaceEqualsTheSurfaceBasis) {
  const Training t;
  const MarkerBasis trained = basis_from_training(t.labels, t.actor.pose_names(), t.captured);
  const MarkerBasis surface = basis_from_surface(t.actor, t.labels, t.places);
  EXPECT_EQ(trained.columns, surface.columns);
  EXPECT_EQ(trained.labels, surface.labels);
  EXPECT_TRUE(trained.notes.empty());
  EXPECT_EQ(trained.at(3, 1), t.captured[1].row(3).transpose());
}

TEST(MarkerBasis, MissingMarkersAreFilledFromThoseAround) {
  Training t;
  const Points truth = t.captured[1];
  t.captured[1].row(11).setConstant(std::nan(""));
  const MarkerBasis basis = basis_from_training(t.labels, t.actor.pose_names(), t.captured);
  const double motion = (truth.row(11) - t.captured[0].row(11)).norm();
  const double error = (basis.at(11, 1) - truth.row(11).transpose()).norm();
  EXPECT_GT(motion, 3.0);
  EXPECT_LT(error, 0.35 * motion);  // markers stand 25 mm apart, the bump has a radius of 30 mm
  ASSERT_EQ(basis.notes.size(), 1u);
  EXPECT_NE(basis.notes[0].find("smile"), std::string::npos);
}

TEST(MarkerBasis, MarkersMissingInTheNeutralAreLeftOut) {
  Training t;
  t.captured[0].row(5).setConstant(std::nan(""));
  const MarkerBasis basis = basis_from_training(t.labels, t.actor.pose_names(), t.captured);
  EXPECT_EQ(basis.markers(), 48);
  EXPECT_EQ(std::count(basis.labels.begin(), basis.labels.end(), "M5"), 0);
  EXPECT_EQ(basis.at(5, 1), t.captured[1].row(6).transpose());
}

TEST(MarkerBasis, PosesThatWereNotCapturedAreNotUsable) {
  Training t;
  t.captured[2].resize(0, 3);
  t.captured[3].topRows(30).setConstant(std::nan(""));
  const MarkerBasis basis = basis_from_training(t.labels, t.actor.pose_names(), t.captured);
  EXPECT_EQ(basis.usable, (std::vector<bool>{true, true, false, false, true, true}));
  EXPECT_EQ(basis.notes.size(), 2u);
}

TEST(MarkerBasis, BadInputIsRefused) {
  Training t;
  EXPECT_THROW(basis_from_training(t.labels, {"neutral"}, t.captured), InputError);
  auto without_neutral = t.captured;
  without_neutral[0].resize(0, 3);
  EXPECT_THROW(basis_from_training(t.labels, t.actor.pose_names(), without_neutral), InputError);
  auto ragged = t.captured;
  ragged[1].conservativeResize(10, 3);
  EXPECT_THROW(basis_from_training(t.labels, t.actor.pose_names(), ragged), InputError);
}

}  // namespace
}  // namespace vultus::retarget
