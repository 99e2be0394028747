#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/error.h"
#include "core/transform.h"
#include "register/face_search.h"
#include "register/subdivide.h"
#include "register/template_head.h"
#include "with_finder.h"

namespace vultus::registration {
namespace {

class FaceSearching : public test::WithFinder {};

Mesh joined(const Mesh& a, const Mesh& b) {
  Triangles triangles(a.topology->triangles().rows() + b.topology->triangles().rows(), 3);
  triangles << a.topology->triangles(), (b.topology->triangles().array() + a.topology->vertex_count()).matrix();
  Mesh both;
  both.positions.resize(a.positions.rows() + b.positions.rows(), 3);
  both.positions << a.positions, b.positions;
  both.topology = Topology::from_triangles(static_cast<int>(both.positions.rows()), triangles);
  return both;
}

TEST_F(FaceSearching, TellsOfASecondHeadStandingOnItsTop) {
  const Template head = template_head();
  const LoopSubdivision loop(head.topology, head.subdivisions);
  Mesh upright;
  upright.topology = loop.refined();
  upright.positions = loop(head.neutral);
  Mesh other = upright;
  Similarity pose;
  pose.rotation = Eigen::AngleAxisd(2.8, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  pose.translation = {300.0, 60.0, 0.0};
  other.positions = transformed(pose, upright.positions);
  const FaceSearch found = search_face(ScanPictures(joined(upright, other)), *finder);
  ASSERT_EQ(found.others.size(), 1u);
  // One of both is taken and the other told of, each within 12 degrees of its own axes.
  const bool first = found.place.target.centre.x() < 150.0;
  const FacePlace& a = first ? found.place : found.others[0];
  const FacePlace& b = first ? found.others[0] : found.place;
  EXPECT_GT(a.frame.col(1).y(), 0.97);
  EXPECT_GT(b.frame.col(1).dot(pose.rotation.col(1)), 0.97);
}

TEST_F(FaceSearching, SaysSoWhenThereIsNoFace) {
  // A wavy patch of cloth.
  const int side = 40;
  Points positions(side * side, 3);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      positions.row(y * side + x) << 6.0 * x, 6.0 * y, 6.0 * std::sin(0.5 * x) + 4.0 * std::sin(0.35 * y + 0.2 * x);
  Triangles triangles(2 * (side - 1) * (side - 1), 3);
  int t = 0;
  for (int y = 0; y + 1 < side; ++y)
    for (int x = 0; x + 1 < side; ++x) {
      const int a = y * side + x;
      triangles.row(t++) << a, a + 1, a + side + 1;
      triangles.row(t++) << a, a + side + 1, a + side;
    }
  Mesh cloth;
  cloth.positions = positions;
  cloth.topology = Topology::from_triangles(side * side, triangles);
  EXPECT_THROW(search_face(ScanPictures(cloth), *finder), InputError);
}

}  // namespace
}  // namespace vultus::registration
