#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "core/error.h"
#include "core/random.h"
#include "register/geometric_landmarks.h"
#include "register/refined_template.h"
#include "register/shape_pose.h"
#include "register/template_head.h"

namespace vultus::registration {
namespace {

// Subdivided once: finding a face's shape looks at samples, and a quarter of the vertices is quicker.
const RefinedTemplate& model() {
  static const RefinedTemplate built([] {
    Template head = template_head();
    head.subdivisions = 1;
    return head;
  }());
  return built;
}

Mesh shape_of(const Points& positions) {
  Mesh mesh;
  mesh.topology = model().loop.refined();
  mesh.positions = positions;
  return mesh;
}

Similarity lying_on_its_side() {
  Similarity pose;
  pose.rotation = (Eigen::AngleAxisd(2.0, Eigen::Vector3d(0.3, 1.0, -0.6).normalized()) *
                   Eigen::AngleAxisd(-1.4, Eigen::Vector3d::UnitX()))
                      .toRotationMatrix();
  pose.translation = {400.0, -70.0, 900.0};
  return pose;
}

// Another person: longer and narrower, with other cheeks.
Points someone_else(const Points& neutral) {
  Points other = neutral;
  for (int v = 0; v < other.rows(); ++v) {
    const Eigen::Vector3d p = neutral.row(v);
    other.row(v) << 0.95 * p.x(), 1.06 * p.y() - 0.01 * p.z(),
        p.z() + 3.0 * std::sin(0.03 * p.x()) * std::cos(0.04 * p.y());
  }
  return other;
}

TEST(ShapePose, FindsItsOwnShapeInAnyPose) {
  const Similarity truth = lying_on_its_side();
  const Mesh scan = shape_of(transformed(truth, model().neutral));
  const ScanSurface surface(scan);
  const auto found =
      find_shape_pose(shape_of(model().neutral), model().topology().set("face"), (*model().head.ibug68)[30], surface);
  ASSERT_TRUE(found);
  // The same surface: the alignment ends in it, up to its own tolerance.
  EXPECT_LT((transformed(found->scan_from_face, model().neutral) - scan.positions).rowwise().norm().maxCoeff(), 0.5);
  EXPECT_GT(found->score, 0.9);
  EXPECT_LT(found->runner_up, 0.5);  // nothing else on a head is a face
}

TEST(GeometricLandmarks, LieOnTheFeaturesOfAnotherPersonInMetresAndSaySo) {
  Similarity pose = lying_on_its_side();
  pose.scale = 0.001;
  const Points truth = transformed(pose, someone_else(model().neutral));
  const DetectedLandmarks found = detect_landmarks_by_shape(model(), model().neutral, false, shape_of(truth));
  EXPECT_GT(found.scan_from_face.col(2).dot(pose.rotation.col(2)), 0.99);
  std::vector<double> errors;
  for (const ScanLandmark& landmark : found.points) {
    const auto index = ibug_index(landmark.name);
    ASSERT_TRUE(index);
    EXPECT_LT(landmark.confidence, 0.7) << landmark.name;  // below what a picture is worth
    EXPECT_FALSE(landmark.pictured);
    if (!is_contour(*index))
      errors.push_back((landmark.position.transpose() - truth.row((*model().head.ibug68)[*index])).norm() / pose.scale);
  }
  ASSERT_EQ(errors.size(), 51u);
  std::nth_element(errors.begin(), errors.begin() + 25, errors.end());
  EXPECT_LT(errors[25], 2.5);  // 6 % of growth moves points by up to 6 mm against a rigid fit; skin slides some of it
}

TEST(GeometricLandmarks, ABallHasNoFace) {
  Mesh ball = shape_of(model().neutral);
  for (int v = 0; v < ball.positions.rows(); ++v)
    ball.positions.row(v) *= 110.0 / std::max(1.0, ball.positions.row(v).norm());
  EXPECT_THROW(detect_landmarks_by_shape(model(), model().neutral, false, ball), InputError);
}

}  // namespace
}  // namespace vultus::registration
