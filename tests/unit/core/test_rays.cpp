#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/random.h"
#include "core/rays.h"

namespace vultus {
namespace {

/// The square 0 … 10 in z = `z`, as two triangles.
Mesh square(double z) {
  Mesh mesh;
  mesh.positions.resize(4, 3);
  mesh.positions << 0, 0, z, 10, 0, z, 10, 10, z, 0, 10, z;
  Triangles triangles(2, 3);
  triangles << 0, 1, 2, 0, 2, 3;
  mesh.topology = Topology::from_triangles(4, triangles);
  return mesh;
}

/// Random triangles about `centre`, for comparison with brute force.
Mesh soup(int count, const Eigen::RowVector3d& centre, std::uint64_t seed) {
  Random random(seed);
  Mesh mesh;
  mesh.positions.resize(3 * count, 3);
  Triangles triangles(count, 3);
  for (int t = 0; t < count; ++t) {
    const Eigen::RowVector3d middle(random.uniform(-50, 50), random.uniform(-50, 50), random.uniform(-50, 50));
    for (int k = 0; k < 3; ++k) {
      const Eigen::RowVector3d offset(random.normal(), random.normal(), random.normal());
      mesh.positions.row(3 * t + k) = centre + middle + 6.0 * offset;
      triangles(t, k) = 3 * t + k;
    }
  }
  mesh.topology = Topology::from_triangles(3 * count, triangles);
  return mesh;
}

/// Nearest point of a triangle by brute force: its interior if the foot of the perpendicular is inside, else its edges.
double distance_to_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d corner[3]) {
  const Eigen::Vector3d normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
  bool inside = true;
  double nearest = 1e300;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d a = corner[k], edge = corner[(k + 1) % 3] - a;
    if (normal.dot(edge.cross(p - a)) < 0) inside = false;
    const double along = std::clamp(edge.dot(p - a) / edge.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (a + along * edge - p).norm());
  }
  return inside ? std::abs(normal.dot(p - corner[0])) : nearest;
}

TEST(Rays, HitsASquareWhereExpected) {
  const Mesh mesh = square(5);
  const RayScene scene(*mesh.topology, mesh.positions);
  const auto hit = scene.hit({7, 2, 0}, {0, 0, 3});  // the direction's length does not matter
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance, 5.0, 1e-12);
  EXPECT_EQ(hit->place.triangle, 0);
  EXPECT_NEAR((position_of(hit->place, *mesh.topology, mesh.positions) - Eigen::Vector3d(7, 2, 5)).norm(), 0, 1e-12);
  EXPECT_FALSE(scene.hit({7, 2, 0}, {0, 0, -1}));
  EXPECT_FALSE(scene.hit({11, 2, 0}, {0, 0, 1}));
}

TEST(Rays, HonoursTheRange) {
  const Mesh mesh = square(5);
  const RayScene scene(*mesh.topology, mesh.positions);
  EXPECT_FALSE(scene.hit({7, 2, 0}, {0, 0, 1}, 0.0, 4.9));
  EXPECT_FALSE(scene.hit({7, 2, 0}, {0, 0, 1}, 5.1, 100.0));
  EXPECT_TRUE(scene.hit({7, 2, 0}, {0, 0, 1}, 4.9, 5.1));
  EXPECT_TRUE(scene.occluded({7, 2, 0}, {0, 0, 1}, 0.0, 5.1));
  EXPECT_FALSE(scene.occluded({7, 2, 0}, {0, 0, 1}, 0.0, 4.9));
  EXPECT_FALSE(scene.occluded({7, 2, 0}, {0, 0, 1}, 5.1, 100.0));
  EXPECT_FALSE(scene.closest({7, 2, 0}, 4.9));
  EXPECT_TRUE(scene.closest({7, 2, 0}, 5.1));
}

TEST(Rays, NoRaySlipsThroughASharedEdge) {
  const Mesh mesh = square(5);
  const RayScene scene(*mesh.topology, mesh.positions);
  for (int i = 1; i < 1000; ++i) EXPECT_TRUE(scene.hit({0.01 * i, 0.01 * i, -30}, {0, 0, 1})) << i;
}

TEST(Rays, HitsLieOnTheRayEvenFarFromTheOrigin) {
  // 100 m away single precision resolves 8 µm; the scene is held about its own centre.
  const Eigen::Vector3d centre(1e5, -2e5, 3e4);
  const Mesh mesh = soup(200, centre.transpose(), 5);
  const RayScene scene(*mesh.topology, mesh.positions);
  Random random(6);
  int hits = 0;
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d origin =
        centre + 100 * Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    const Eigen::Vector3d direction =
        (centre + Eigen::Vector3d(random.uniform(-30, 30), random.uniform(-30, 30), 0) - origin).normalized();
    const auto hit = scene.hit(origin, direction);
    if (!hit) continue;
    ++hits;
    const Eigen::Vector3d on_mesh = position_of(hit->place, *mesh.topology, mesh.positions);
    EXPECT_NEAR((on_mesh - (origin + hit->distance * direction)).norm(), 0, 1e-6);
  }
  EXPECT_GT(hits, 250);
}

TEST(Rays, ClosestPointAgreesWithBruteForce) {
  const Mesh mesh = soup(300, {0, 0, 0}, 8);
  const RayScene scene(*mesh.topology, mesh.positions);
  Random random(9);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d p(random.uniform(-90, 90), random.uniform(-90, 90), random.uniform(-90, 90));
    double expected = 1e300;
    for (int t = 0; t < 300; ++t) {
      const Eigen::Vector3d corner[3] = {mesh.positions.row(3 * t), mesh.positions.row(3 * t + 1),
                                         mesh.positions.row(3 * t + 2)};
      expected = std::min(expected, distance_to_triangle(p, corner));
    }
    const auto found = scene.closest(p);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->distance, expected, 1e-9);
    EXPECT_NEAR((found->position - p).norm(), found->distance, 1e-12);
    EXPECT_NEAR((position_of(found->place, *mesh.topology, mesh.positions) - found->position).norm(), 0, 1e-9);
    EXPECT_NEAR(found->place.barycentric.sum(), 1.0, 1e-12);
    EXPECT_GE(found->place.barycentric.minCoeff(), 0.0);
  }
}

TEST(Rays, EquallyNearTrianglesGiveTheLowestIndex) {
  const Mesh mesh = square(0);
  const RayScene scene(*mesh.topology, mesh.positions);
  EXPECT_EQ(scene.closest({5, 5, 3})->place.triangle, 0);    // on the shared diagonal
  EXPECT_EQ(scene.closest({-1, -1, 0})->place.triangle, 0);  // at the shared corner
}

TEST(Rays, AnswersAreTheSameFromManyThreads) {
  const Mesh mesh = soup(500, {0, 0, 0}, 3);
  const RayScene scene(*mesh.topology, mesh.positions);
  const auto query = [&](int i) {
    const Eigen::Vector3d p(std::sin(i) * 80, std::cos(2.3 * i) * 80, std::sin(0.7 * i) * 80);
    const auto hit = scene.hit(p, -p);
    return std::pair(scene.closest(p)->distance, hit ? hit->distance : -1.0);
  };
  std::vector<std::pair<double, double>> together(2000);
  tbb::parallel_for(0, 2000, [&](int i) { together[i] = query(i); });
  for (int i = 0; i < 2000; ++i) ASSERT_EQ(together[i], query(i));
}

TEST(Rays, EmptyAndDegenerateMeshesAreNeverHit) {
  const RayScene empty(*Topology::from_triangles(0, Triangles(0, 3)), Points(0, 3));
  EXPECT_FALSE(empty.hit({0, 0, 0}, {0, 0, 1}));
  EXPECT_FALSE(empty.occluded({0, 0, 0}, {0, 0, 1}, 0, 1e9));
  EXPECT_FALSE(empty.closest({0, 0, 0}));

  Points line(3, 3);
  line << 0, 0, 0, 1, 0, 0, 2, 0, 0;
  Triangles triangle(1, 3);
  triangle << 0, 1, 2;
  const RayScene sliver(*Topology::from_triangles(3, triangle), line);
  EXPECT_NEAR(sliver.closest({1.5, 2, 0})->distance, 2.0, 1e-12);
}

TEST(Rays, RefusesBadPositions) {
  Mesh mesh = square(0);
  mesh.positions(2, 1) = std::nan("");
  EXPECT_THROW(RayScene(*mesh.topology, mesh.positions), InputError);
  EXPECT_THROW(RayScene(*mesh.topology, Points::Zero(3, 3)), InputError);
}

}  // namespace
}  // namespace vultus
