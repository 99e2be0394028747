#include <gtest/gtest.h>

#include "core/error.h"
#include "register/subdivide.h"

namespace vultus::registration {
namespace {

std::shared_ptr<const Topology> tetrahedron() {
  Triangles triangles(4, 3);
  triangles << 0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3;
  return Topology::from_triangles(4, triangles);
}

Points tetrahedron_positions() {
  Points positions(4, 3);
  positions << 1, 1, 1, -1, -1, 1, 1, -1, -1, -1, 1, -1;
  return positions;
}

// Two triangles that share the diagonal 0–2 of the unit square, with two UV charts cut along it.
std::shared_ptr<const Topology> cut_square() {
  TopologyData data;
  data.vertex_count = 4;
  data.face_offsets = {0, 3, 6};
  data.corner_vertex = {0, 1, 2, 0, 2, 3};
  data.corner_uv = {0, 1, 2, 3, 4, 5};
  data.uvs.resize(6, 2);
  data.uvs << 0, 0, 0.4, 0, 0.4, 0.4, 0.5, 0.5, 1, 1, 0.5, 1;
  data.sets["right"] = {0, 1, 2};
  data.landmarks["corner"] = 3;
  return Topology::make(std::move(data));
}

TEST(LoopSubdivision, TetrahedronFollowsLoopsWeights) {
  const LoopSubdivision loop(tetrahedron(), 1);
  const Points control = tetrahedron_positions();
  const Points refined = loop(control);
  ASSERT_EQ(loop.refined()->vertex_count(), 4 + 6);
  ASSERT_EQ(loop.refined()->face_count(), 16);
  // Valence 3: the vertex keeps 1 − 3·3/16 and takes 3/16 of each neighbour (Loop 1987). The neighbours sum to −v.
  for (int v = 0; v < 4; ++v) EXPECT_LT((refined.row(v) - (7.0 / 16 - 3.0 / 16) * control.row(v)).norm(), 1e-6) << v;
  // An edge point takes 3/8 of each end and 1/8 of both opposite vertices, whose sum is minus that of the ends.
  Eigen::Vector3d expected = 0.25 * (control.row(0) + control.row(1)).transpose();
  double nearest = 1e9;
  for (int v = 4; v < 10; ++v) nearest = std::min(nearest, (refined.row(v).transpose() - expected).norm());
  EXPECT_LT(nearest, 1e-6);
}

TEST(LoopSubdivision, CommutesWithAffineMaps) {
  const LoopSubdivision loop(tetrahedron(), 3);
  const Points control = tetrahedron_positions();
  Eigen::Matrix3d linear;
  linear << 2, 0.3, -1, 0.1, 1.5, 0.2, 0.7, -0.4, 0.9;
  const Eigen::RowVector3d shift(5, -3, 12);
  const Points moved_control = (control * linear).rowwise() + shift;
  const Points expected = (loop(control) * linear).rowwise() + shift;
  // OpenSubdiv stores Loop's weights in double, exact up to rounding over three levels.
  EXPECT_LT((loop(moved_control) - expected).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(LoopSubdivision, BoundaryIsACubicSplineCurve) {
  const LoopSubdivision loop(cut_square(), 1);
  Points control(4, 3);
  control << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
  const Points refined = loop(control);
  // Boundary vertex: 3/4 of itself and 1/8 of both neighbours along the boundary.
  EXPECT_LT((refined.row(1) - Eigen::RowVector3d(0.875, 0.125, 0)).norm(), 1e-6);
}

TEST(LoopSubdivision, CarriesSetsLandmarksAndCharts) {
  const LoopSubdivision loop(cut_square(), 2);
  const Topology& refined = *loop.refined();
  EXPECT_EQ(refined.landmarks().at("corner"), 3);
  Points control(4, 3);
  control << 0, 0, 0, 4, 0, 0, 4, 4, 0, 0, 4, 0;
  // The set is one of both triangles: 15 of its two-level refinement's vertices.
  EXPECT_EQ(refined.set("right").size(), 15u);
  ASSERT_TRUE(refined.has_uvs());
  const Triangles& uv_of = refined.triangle_uvs();
  double area = 0;
  for (int t = 0; t < uv_of.rows(); ++t) {
    const Eigen::Vector2d a = refined.uvs().row(uv_of(t, 0)), b = refined.uvs().row(uv_of(t, 1)),
                          c = refined.uvs().row(uv_of(t, 2));
    // No triangle spans the cut between the charts.
    EXPECT_EQ(a.maxCoeff() < 0.45, b.maxCoeff() < 0.45);
    EXPECT_EQ(a.maxCoeff() < 0.45, c.maxCoeff() < 0.45);
    const double twice = (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
    EXPECT_GT(twice, 0);
    area += 0.5 * twice;
  }
  EXPECT_NEAR(area, 0.08 + 0.125, 1e-6);  // charts keep their outline: 0.4²/2 + 0.5²/2
}

TEST(LoopSubdivision, ZeroLevelsKeepThePolygons) {
  const auto square = cut_square();
  const LoopSubdivision loop(square, 0);
  EXPECT_EQ(loop.refined(), square);
}

TEST(LoopSubdivision, RefusesWrongInput) {
  EXPECT_THROW(LoopSubdivision(tetrahedron(), 7), InputError);
  EXPECT_THROW(LoopSubdivision(tetrahedron(), -1), InputError);
  const LoopSubdivision loop(tetrahedron(), 1);
  EXPECT_THROW(loop(Points::Zero(5, 3)), InputError);
}

}  // namespace
}  // namespace vultus::registration
