#include <gtest/gtest.h>

#include "register/consistent.h"
#include "register/strayed_features.h"
#include "scanned_head.h"

namespace vultus::registration {
namespace {

// Vertex i lies at (i, 0, 0) and carries point i of the scheme, found `way` beside it.
struct Found {
  Points fit = Points::Zero(68, 3);
  Anchors anchors;
  Found() {
    for (int i = 0; i < 68; ++i) fit(i, 0) = i;
  }
  void add(int ibug, const Eigen::Vector3d& way, double confidence = 0.5) {
    anchors.add(ibug_name(ibug), ibug, fit.row(ibug).transpose() + way, confidence);
  }
};

TEST(StrayedFeatures, AnEyeIsMovedAsAWholeByItsMeanBeyondTheMargin) {
  Found found;
  for (int i = 36; i < 42; ++i) found.add(i, {0.0, i % 2 == 0 ? 5.0 : 3.0, 0.0});
  const auto terms = strayed_features(found.anchors, found.fit, true);
  ASSERT_EQ(terms.size(), 6u);
  for (const PointTerm& term : terms)  // the mean is 4 mm off, 1 mm is the finder's own
    EXPECT_NEAR((term.target - Eigen::Vector3d(term.vertex, 3.0, 0.0)).norm(), 0.0, 1e-12) << term.vertex;
}

TEST(StrayedFeatures, PointsThatScatterAboutTheFitHaveNotStrayed) {
  Found found;
  for (int i = 42; i < 48; ++i) found.add(i, {0.0, i % 2 == 0 ? 6.0 : -6.0, 0.0});
  EXPECT_TRUE(strayed_features(found.anchors, found.fit, true).empty());
}

TEST(StrayedFeatures, BareShapeTellsNothingOfBrowsAndLessOfEyes) {
  Found found;
  for (int i = 17; i < 27; ++i) found.add(i, {0.0, 5.0, 0.0});
  for (int i = 42; i < 48; ++i) found.add(i, {0.0, 2.0, 0.0});
  EXPECT_TRUE(strayed_features(found.anchors, found.fit, false).empty());
  EXPECT_EQ(strayed_features(found.anchors, found.fit, true).size(), 16u);
}

TEST(StrayedFeatures, PointsPlacedByHandAndLonePointsMoveNothing) {
  Found found;
  for (int i = 36; i < 42; ++i) found.add(i, {0.0, 5.0, 0.0}, 1.0);
  for (int i = 42; i < 44; ++i) found.add(i, {0.0, 5.0, 0.0});
  for (int i = 48; i < 60; ++i) found.add(i, {0.0, 5.0, 0.0});  // lips move
  EXPECT_TRUE(strayed_features(found.anchors, found.fit, true).empty());
}

// Landmarks that only start a fit are given way to by its end, which then finds the eyes where they truly are.
TEST(StrayedFeatures, ANeutralsEyesAreLedToWhereTheyWereFound) {
  const test::ScannedHead person = test::scanned_head(1.04, 0.97, 3);
  const Ibug68& points = *person.head.ibug68;
  ScanLandmarks landmarks = person.landmarks;
  std::erase_if(landmarks, [](const ScanLandmark& placed) { return placed.name.starts_with("3."); });  // of the eyes
  for (int i = 36; i < 48; ++i)
    landmarks.push_back({ibug_name(i), person.truth.row(points[i]).transpose() + Eigen::Vector3d(0.0, 6.0, 0.0), 0.5});
  const Registered found = register_neutral(person.head, person.scan, landmarks, {}, Progress::none());
  const Points in_scan = transformed(found.face_from_scan.inverse(), found.mesh.positions);
  double above = 0.0;
  for (int i = 36; i < 48; ++i) above += (in_scan(points[i], 1) - person.truth(points[i], 1)) / 12.0;
  EXPECT_GT(above, 1.0);  // of the 6 mm less a finder's 2.5; the scan's surface holds against it
}

}  // namespace
}  // namespace vultus::registration
