#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/transform.h"
#include "register/anchors.h"
#include "register/detect_landmarks.h"
#include "register/subdivide.h"
#include "register/template_head.h"
#include "with_finder.h"

namespace vultus::registration {
namespace {

class DetectLandmarks : public test::WithFinder {};

TEST_F(DetectLandmarks, FindsTheFaceOfAHeadThatIsTurnedAndLaidOnItsSide) {
  const Template head = template_head();
  const LoopSubdivision loop(head.topology, head.subdivisions);
  Mesh scan;
  scan.topology = loop.refined();
  Similarity pose;
  pose.scale = 0.1;  // centimetres: finding must not depend on units
  pose.rotation =
      (Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(0.35, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  scan.positions = transformed(pose, loop(head.neutral));
  const DetectedLandmarks found = detect_landmarks(scan, *finder);
  // The axes come from eyes and mouth seen from the front: within some 12 degrees of the head's own.
  EXPECT_GT(found.scan_from_face.col(2).dot(pose.rotation.col(2)), 0.97);
  EXPECT_GT(found.scan_from_face.col(1).dot(pose.rotation.col(1)), 0.97);
  EXPECT_NEAR(unit_correction(found.outer_eye_distance), 10.0, 1e-9);
  std::vector<double> errors;
  for (const ScanLandmark& landmark : found.points) {
    const int index = *ibug_index(landmark.name);
    if (is_contour(index) || landmark.confidence < 0.15) continue;
    const Eigen::Vector3d truth = pose * Eigen::Vector3d(head.neutral.row((*head.ibug68)[index]));
    errors.push_back((landmark.position - truth).norm() / pose.scale);
  }
  ASSERT_GT(errors.size(), 40u);
  std::nth_element(errors.begin(), errors.begin() + errors.size() / 2, errors.end());
  EXPECT_LT(errors[errors.size() / 2], 6.0);  // dlib on a bare grey shape is biased by some millimetres
}

TEST(FaceFinderModel, MissingOrWrongFilesAreNamed) { EXPECT_THROW(FaceFinder("/nowhere/model.dat"), InputError); }

TEST(Anchors, UnitsFollowTheEyes) {
  EXPECT_EQ(unit_correction(90.0), 1.0);
  EXPECT_EQ(unit_correction(9.0), 10.0);
  EXPECT_EQ(unit_correction(0.09), 1000.0);
  EXPECT_EQ(unit_correction(90000.0), 0.001);
  EXPECT_EQ(unit_correction(0.0), 1.0);
}

TEST(Anchors, ALandmarkBeyondWhatSkinCanDoIsLeftOutWithItsEye) {
  Anchors anchors;
  anchors.names = {ibug_name(36), ibug_name(37), ibug_name(42), ibug_name(57), "placed"};
  anchors.vertices = {0, 1, 2, 3, 4};
  anchors.confidence = Eigen::VectorXd::Constant(5, 0.5);
  anchors.confidence[4] = 1.0;
  const Points rest = Points::Zero(5, 3);
  anchors.targets = Points::Zero(5, 3);
  anchors.targets(0, 1) = 9.0;    // an eye corner does not rise by 9 mm
  anchors.targets(3, 1) = -30.0;  // a lower lip may fall by 30
  anchors.targets(4, 1) = 99.0;   // placed by hand: taken as it is
  const Anchors kept = plausible_anchors(anchors, rest);
  EXPECT_EQ(kept.names, (std::vector<std::string>{ibug_name(42), ibug_name(57), "placed"}));
  EXPECT_EQ(kept.vertices, (std::vector<int>{2, 3, 4}));
}

}  // namespace
}  // namespace vultus::registration
