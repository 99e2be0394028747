#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "register/align.h"
#include "register/orientation.h"
#include "synthetic_surfaces.h"

namespace vultus::registration {
namespace {

Similarity some_motion(double scale) {
  Similarity motion;
  motion.scale = scale;
  motion.rotation = (Eigen::AngleAxisd(0.15, Eigen::Vector3d(1, 2, -0.5).normalized())).toRotationMatrix();
  motion.translation = {3.0, -4.0, 2.5};
  return motion;
}

double farthest(const Similarity& a, const Similarity& b, const Points& points) {
  return (transformed(a, points) - transformed(b, points)).rowwise().norm().maxCoeff();
}

TEST(AlignLandmarks, FindsTheMotionDespiteWrongPoints) {
  Random random(3);
  Points source(30, 3);
  for (int i = 0; i < 30; ++i)
    source.row(i) << random.uniform(-60, 60), random.uniform(-60, 60), random.uniform(-30, 30);
  const Similarity truth = some_motion(1.1);
  Points target = transformed(truth, source);
  for (int i : {3, 11, 20, 27}) target.row(i) += Eigen::RowVector3d(25, -30, 10);
  const Alignment found = align_landmarks(source, target, Eigen::VectorXd::Ones(30), Scaling::free);
  EXPECT_LT(farthest(found.scan_from_template, truth, source), 1e-6);
  EXPECT_NEAR(found.residuals[3], std::sqrt(25 * 25 + 30 * 30 + 10 * 10), 1e-5);
}

TEST(AlignLandmarks, IgnoresPointsWithoutConfidence) {
  Points source(8, 3);
  source << 0, 0, 0, 50, 0, 0, 0, 50, 0, 0, 0, 50, 50, 50, 0, 20, 10, 5, 9, 9, 9, 30, 20, 10;
  Points target = source;
  for (int i : {6, 7}) target.row(i) += Eigen::RowVector3d(40, 40, 40);
  Eigen::VectorXd confidence = Eigen::VectorXd::Ones(8);
  confidence[6] = confidence[7] = 0.0;
  const Alignment found = align_landmarks(source, target, confidence, Scaling::fixed);
  EXPECT_LT(farthest(found.scan_from_template, Similarity{}, source), 1e-9);
  confidence.setZero();
  EXPECT_THROW(align_landmarks(source, target, confidence, Scaling::fixed), InputError);
}

// Forward, inverse and shifted: the same truth must come out whichever surface is moved (as small_gicp tests).
class AlignSurface : public testing::Test {
 protected:
  Mesh model = test::bumpy_sphere(60, 0.0, 1), scan = test::bumpy_sphere(83, 0.02, 2);
  std::vector<int> all = test::every(model, 4);
};

TEST_F(AlignSurface, Forward) {
  const Similarity truth = some_motion(1.0);
  Mesh moved = scan;
  moved.positions = transformed(truth, scan.positions);
  const ScanSurface surface(moved);
  const Alignment found = align_surface(*model.topology, model.positions, all, surface, Similarity{}, Scaling::fixed);
  // 0.02 mm noise over thousands of vertices; both triangulations lie some 0.05 mm inside the curved surface.
  EXPECT_LT(farthest(found.scan_from_template, truth, model.positions), 0.1);
  EXPECT_LT(found.rms, 0.2);
}

TEST_F(AlignSurface, Inverse) {
  const Similarity truth = some_motion(1.0);
  Mesh moved = model;
  moved.positions = transformed(truth, model.positions);
  const ScanSurface surface(scan);
  const Alignment found = align_surface(*moved.topology, moved.positions, all, surface, Similarity{}, Scaling::fixed);
  EXPECT_LT(farthest(found.scan_from_template * truth, Similarity{}, model.positions), 0.1);
}

TEST_F(AlignSurface, FreeScaleIsFoundAndFixedScaleStays) {
  Similarity truth = some_motion(1.04);
  Mesh moved = scan;
  moved.positions = transformed(truth, scan.positions);
  const ScanSurface surface(moved);
  const Alignment found = align_surface(*model.topology, model.positions, all, surface, Similarity{}, Scaling::free);
  EXPECT_NEAR(found.scan_from_template.scale, 1.04, 0.001);
  const Alignment rigid = align_surface(*model.topology, model.positions, all, surface, Similarity{}, Scaling::fixed);
  EXPECT_NEAR(rigid.scan_from_template.scale, 1.0, 1e-12);
}

TEST_F(AlignSurface, AMovedPartDoesNotPull) {
  Mesh moved = scan;
  for (int v = 0; v < moved.positions.rows(); ++v)
    if (moved.positions(v, 1) < -40) moved.positions(v, 1) -= 4.0;  // a dropped jaw: a quarter of the surface
  const ScanSurface surface(moved);
  const Alignment found = align_surface(*model.topology, model.positions, all, surface, Similarity{}, Scaling::fixed);
  EXPECT_LT(farthest(found.scan_from_template, Similarity{}, model.positions), 0.25);
}

TEST(Orientation, TurnsAnyPoseIntoTheModelsFrame) {
  const OrientationPoints model{{-30, 0, 20}, {30, 0, 20}, {0, 2, 28}, {0, -30, 45}, {-45, 0, 12}, {45, 0, 12}};
  Similarity away = some_motion(1.0);
  away.rotation = Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, -1, 0.3).normalized()).toRotationMatrix();
  const OrientationPoints pose{away * model.right_eye, away * model.left_eye,     away * model.ridge_top,
                               away * model.ridge_tip, away * model.right_corner, away * model.left_corner};
  const Similarity back = normalize_orientation(pose, model) * away;
  EXPECT_LT((back.rotation - Eigen::Matrix3d::Identity()).norm(), 1e-9);
  EXPECT_LT(back.translation.norm(), 1e-9);
}

}  // namespace
}  // namespace vultus::registration
