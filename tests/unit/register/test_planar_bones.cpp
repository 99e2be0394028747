#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "core/transform.h"
#include "register/planar_bones.h"

namespace vultus::registration {
namespace {

using Region = BoneBinding::Region;

// One right triangle of 10 mm in the plane z = 0.
ControlSurface one_bone() {
  ControlSurface surface;
  surface.rest.resize(3, 3);
  surface.rest << 0, 0, 0, 10, 0, 0, 0, 10, 0;
  surface.triangles.resize(1, 3);
  surface.triangles << 0, 1, 2;
  return surface;
}

// A 4×4 grid of control points 10 mm apart over z = bulge(x, y).
ControlSurface grid() {
  ControlSurface surface;
  surface.rest.resize(16, 3);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) surface.rest.row(4 * i + j) << 10.0 * j, 10.0 * i, 2.0 * std::sin(0.1 * (i + 2 * j));
  surface.triangles.resize(18, 3);
  int t = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int a = 4 * i + j;
      surface.triangles.row(t++) << a, a + 1, a + 5;
      surface.triangles.row(t++) << a, a + 5, a + 4;
    }
  return surface;
}

Points skin_over_grid() {
  Points skin(400, 3);
  Random random(3);
  for (int i = 0; i < skin.rows(); ++i)
    skin.row(i) << random.uniform(-3.0, 33.0), random.uniform(-3.0, 33.0), random.uniform(-1.0, 4.0);
  return skin;
}

Points row(double x, double y, double z) {
  Points points(1, 3);
  points << x, y, z;
  return points;
}

BoneBinding binding_of(double x, double y, double z) {
  PlanarBoneOptions everywhere;
  everywhere.everywhere = true;
  return PlanarBones(one_bone(), row(x, y, z), {}, everywhere).bindings(0)[0];
}

TEST(PlanarBones, RegionsOfOneTriangle) {
  EXPECT_EQ(binding_of(2, 3, 1).region, Region::face);
  const BoneBinding below = binding_of(5, -2, 1), slant = binding_of(7, 7, 0), left = binding_of(-1, 5, 0);
  EXPECT_EQ(below.region, Region::edge);
  EXPECT_EQ(below.corner, 0);
  EXPECT_EQ(slant.region, Region::edge);
  EXPECT_EQ(slant.corner, 1);
  EXPECT_EQ(left.region, Region::edge);
  EXPECT_EQ(left.corner, 2);
  EXPECT_EQ(binding_of(-1, -1, 0).region, Region::apex);
  EXPECT_EQ(binding_of(-1, -1, 0).corner, 0);
  EXPECT_EQ(binding_of(14, -1, 0).corner, 1);
  EXPECT_EQ(binding_of(-1, 14, 0).corner, 2);
  // Beyond two edge lines, but opposite to an edge all the same (eq. 5): a candidate apex that is an edge.
  const BoneBinding beside = binding_of(10.5, -0.1, 0);
  EXPECT_EQ(beside.region, Region::apex);
  EXPECT_EQ(beside.corner, 1);
}

TEST(PlanarBones, HandSolvedDeformations) {
  Points skin(3, 3);
  skin << 2, 2, 1, 5, -2, 0, -3, -4, 0;  // face, edge, apex
  PlanarBoneOptions everywhere;
  everywhere.everywhere = true;
  const PlanarBones bones(one_bone(), skin, {}, everywhere);
  Points control = bones.surface().rest;
  control *= 2.0;  // twice as large
  const Points moved = bones(control);
  // The face grows in its plane and keeps heights (eq. 1); the edge region grows along the edge only (eq. 9); the apex
  // region not at all (eq. 10).
  EXPECT_NEAR((moved.row(0) - Eigen::RowVector3d(4, 4, 1)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((moved.row(1) - Eigen::RowVector3d(10, -2, 0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((moved.row(2) - Eigen::RowVector3d(-3, -4, 0)).norm(), 0.0, 1e-9);
}

TEST(PlanarBones, ApexKeepsItsDistanceWhenTheCornerOpens) {
  const Points skin = row(-3, -4, 0);
  PlanarBoneOptions everywhere;
  everywhere.everywhere = true;
  const PlanarBones bones(one_bone(), skin, {}, everywhere);
  Points control = bones.surface().rest;
  control.row(2) << -8, 10, 0;
  EXPECT_NEAR(bones(control).row(0).norm(), 5.0, 1e-9);
  EXPECT_GT((bones(control) - skin).norm(), 0.1);
}

TEST(PlanarBones, WeightFallsByACosine) {
  // The longest edge is the radius of a bone without neighbours; half of it away, the weight is one half.
  PlanarBoneOptions options;
  options.reach = 1.0;
  const double radius = std::sqrt(200.0);
  Points skin(4, 3);
  skin << 2, 2, 0, 2, 2, 0.5 * radius, 2, 2, 0.999 * radius, 2, 2, 1.01 * radius;
  const PlanarBones bones(one_bone(), skin, {}, options);
  Points control = bones.surface().rest;
  control.col(2).array() += 4.0;
  const Eigen::VectorXd rise = (bones(control) - skin).col(2);
  EXPECT_NEAR(rise[0], 4.0, 1e-9);
  EXPECT_NEAR(rise[1], 2.0, 1e-9);
  EXPECT_LT(rise[2], 1e-4);
  EXPECT_EQ(rise[3], 0.0);
}

TEST(PlanarBones, RestAndRigidMotionAreExact) {
  for (bool everywhere : {false, true}) {
    PlanarBoneOptions options;
    options.everywhere = everywhere;
    const Points skin = skin_over_grid();
    const PlanarBones bones(grid(), skin, {}, options);
    EXPECT_LT((bones(bones.surface().rest) - skin).cwiseAbs().maxCoeff(), 1e-10);
    if (!everywhere) continue;  // skin out of reach stays by design
    Similarity motion;
    motion.rotation = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
    motion.translation << 5, -30, 12;
    const Points moved = bones(transformed(motion, bones.surface().rest));
    EXPECT_LT((moved - transformed(motion, skin)).cwiseAbs().maxCoeff(), 1e-10);
  }
}

TEST(PlanarBones, SkinAtAControlPointFollowsItAlone) {
  const ControlSurface surface = grid();
  const PlanarBones bones(surface, surface.rest);
  Points control = surface.rest;
  Random random(7);
  for (int i = 0; i < control.rows(); ++i)
    for (int k = 0; k < 3; ++k) control(i, k) += random.uniform(-2.0, 2.0);
  // A reach below 1 keeps every bone from the control points of its neighbours.
  EXPECT_LT((bones(control) - control).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(PlanarBones, InfluenceIsContinuous) {
  PlanarBoneOptions options;
  options.everywhere = true;
  Points line(4001, 3);
  for (int i = 0; i < line.rows(); ++i) line.row(i) << -10.0 + 0.0125 * i, 13.3 + 0.002 * i, 1.5;
  const PlanarBones bones(grid(), line, {}, options);
  Points control = bones.surface().rest;
  control.row(5) += Eigen::RowVector3d(1, 2, 3);
  control.row(10) -= Eigen::RowVector3d(2, 0, 3);
  const Points moved = bones(control) - line;
  double jump = 0.0;
  for (int i = 1; i < line.rows(); ++i) jump = std::max(jump, (moved.row(i) - moved.row(i - 1)).norm());
  // Steps of 0.0127 mm through displacements of 3.7 mm that change over some 7 mm; regions meet without a gap only
  // where bones agree, which eq. 10's rescaling does up to second order.
  EXPECT_LT(jump, 0.03);
  EXPECT_GT(moved.rowwise().norm().maxCoeff(), 1.0);
}

TEST(PlanarBones, DerivativesMatchDifferences) {
  PlanarBoneOptions options;
  options.everywhere = true;
  const Points skin = skin_over_grid();
  const PlanarBones bones(grid(), skin, {}, options);
  Points control = bones.surface().rest;
  Random random(5);
  for (int i = 0; i < control.rows(); ++i)
    for (int k = 0; k < 3; ++k) control(i, k) += random.uniform(-1.0, 1.0);
  std::vector<int> some;
  for (int v = 0; v < skin.rows(); v += 7) some.push_back(v);
  const auto exact = bones.derivatives(control, some);
  EXPECT_LT((exact.positions - bones(control, some)).cwiseAbs().maxCoeff(), 1e-12);
  const double h = 1e-5;
  for (int c = 0; c < control.rows(); ++c)
    for (int axis = 0; axis < 3; ++axis) {
      Points ahead = control, behind = control;
      ahead(c, axis) += h;
      behind(c, axis) -= h;
      const Points slope = (bones(ahead, some) - bones(behind, some)) / (2.0 * h);
      for (std::size_t k = 0; k < some.size(); ++k) {
        Eigen::Vector3d expected = Eigen::Vector3d::Zero();
        for (int i = exact.offsets[k]; i < exact.offsets[k + 1]; ++i)
          if (exact.entries[i].control == c) expected = exact.entries[i].matrix.col(axis);
        EXPECT_LT((slope.row(k).transpose() - expected).norm(), 1e-7);  // central differences: h² and rounding / h
      }
    }
}

TEST(PlanarBones, MasksKeepLipsApart) {
  // Two bones that face each other across a slit of 1 mm, like lips; skin of each lies near its own edge.
  ControlSurface surface;
  surface.rest.resize(6, 3);
  surface.rest << 0, 0.5, 0, 20, 0.5, 0, 10, 12, 0, 0, -0.5, 0, 20, -0.5, 0, 10, -12, 0;
  surface.triangles.resize(2, 3);
  surface.triangles << 0, 1, 2, 4, 3, 5;
  Points skin(2, 3);
  skin << 10, 0.6, 0, 10, -0.6, 0;
  BoneMasks masks{{1u, 2u}, {2u, 1u}};
  Points control = surface.rest;
  control.bottomRows(3).col(1).array() -= 15.0;  // the lower lip drops
  const Points apart = PlanarBones(surface, skin, masks)(control);
  EXPECT_LT((apart.row(0) - skin.row(0)).norm(), 1e-12);
  EXPECT_NEAR(apart(1, 1), -15.6, 1e-9);
  EXPECT_LT(PlanarBones(surface, skin)(control)(0, 1), 0.0);  // without masks it drags the upper one along
}

TEST(PlanarBones, RefusesBadSurfaces) {
  ControlSurface surface = one_bone();
  EXPECT_THROW(PlanarBones(surface, row(0, 0, 0), BoneMasks{{1u}, {}}), InputError);
  surface.triangles(0, 2) = 3;
  EXPECT_THROW(PlanarBones(surface, row(0, 0, 0)), InputError);
  surface.triangles(0, 2) = 1;
  EXPECT_THROW(PlanarBones(surface, row(0, 0, 0)), InputError);
  EXPECT_THROW(PlanarBones(one_bone(), row(0, 0, 0))(Points::Zero(2, 3)), InputError);
}

}  // namespace
}  // namespace vultus::registration
