#include <gtest/gtest.h>

#include "scan/self_intersections.h"

namespace vultus::scan {
namespace {

using Pairs = std::vector<std::pair<int, int>>;

// A square of two triangles in the plane z = 0 and a triangle that stands in it, `sunk` below the plane.
struct Standing {
  Triangles triangles{3, 3};
  Points positions{7, 3};
  explicit Standing(double sunk) {
    positions << 0, 0, 0, 10, 0, 0, 10, 10, 0, 0, 10, 0, 6, 2, -sunk, 8, 2, -sunk, 7, 2, 5;
    triangles << 0, 1, 2, 0, 2, 3, 4, 5, 6;
  }
};

TEST(SelfIntersections, FindsTheTriangleThatPassesThrough) {
  const Standing scene(1.0);
  EXPECT_EQ(self_intersections(scene.triangles, scene.positions), (Pairs{{0, 2}}));  // x > y there: the first half
}

TEST(SelfIntersections, TouchingIsNoIntersection) {
  const Standing touching(0.0), grazing(0.04), apart(-0.1);
  EXPECT_TRUE(self_intersections(touching.triangles, touching.positions).empty());
  EXPECT_TRUE(self_intersections(grazing.triangles, grazing.positions).empty());
  EXPECT_EQ(self_intersections(grazing.triangles, grazing.positions, 0.01).size(), 1u);
  EXPECT_TRUE(self_intersections(apart.triangles, apart.positions).empty());
}

TEST(SelfIntersections, PlanesThatCrossAreNotEnough) {
  Standing scene(1.0);
  for (int v = 4; v < 7; ++v) scene.positions(v, 0) += 20.0;
  EXPECT_TRUE(self_intersections(scene.triangles, scene.positions).empty());
}

TEST(SelfIntersections, NeighboursMeetByRight) {
  Standing scene(1.0);
  scene.triangles.row(2) << 0, 5, 6;  // hangs on the square's corner and passes through it
  EXPECT_TRUE(self_intersections(scene.triangles, scene.positions).empty());
}

}  // namespace
}  // namespace vultus::scan
