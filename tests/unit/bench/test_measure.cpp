#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "apps/bench_registration/measure.h"
#include "apps/bench_registration/openings.h"
#include "apps/bench_registration/statistics.h"
#include "apps/bench_registration/turned_triangles.h"
#include "core/error.h"

namespace vultus::apps::bench {
namespace {

// A square of n×n cells of 1 mm in the plane z = 0, seen from +z.
Mesh square(int n) {
  Points positions((n + 1) * (n + 1), 3);
  Triangles triangles(2 * n * n, 3);
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) positions.row(i * (n + 1) + j) = Eigen::RowVector3d(j, i, 0);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const int a = i * (n + 1) + j;
      triangles.row(2 * (i * n + j)) = Eigen::RowVector3i(a, a + 1, a + n + 2);
      triangles.row(2 * (i * n + j) + 1) = Eigen::RowVector3i(a, a + n + 2, a + n + 1);
    }
  return {Topology::from_triangles((n + 1) * (n + 1), triangles), positions, {}, {}};
}

struct Case {
  Mesh mesh = square(10);
  std::vector<bool> all = std::vector<bool>(121, true);
  Truth truth{mesh, marked_triangles(*mesh.topology, all), mesh.positions};
  registration::Registered result() const {
    registration::Registered registered;
    registered.mesh = mesh;
    return registered;
  }
};

TEST(Measure, PerfectResultIsAtZero) {
  const Case given;
  const Distances distances = measure(given.truth, given.result(), given.all, 1.0);
  EXPECT_EQ(distances.vertex.size(), 121U);
  EXPECT_LT(quantile(distances.vertex, 1.0), 1e-12);
  EXPECT_LT(quantile(distances.surface, 1.0), 1e-5);
}

TEST(Measure, SlidVerticesShowThoughTheSurfaceFits) {
  const Case given;
  registration::Registered slid = given.result();
  slid.mesh.positions.col(0).array() += 0.5;
  const Distances distances = measure(given.truth, slid, given.all, 1.0);
  EXPECT_NEAR(quantile(distances.vertex, 0.5), 0.5, 1e-6);
  // A strip of half a millimetre of ten is uncovered: 5 % of the places, a quarter of a millimetre off on average.
  EXPECT_NEAR(mean(distances.surface), 0.05 * 0.25, 0.002);
}

TEST(Measure, FramesAndUnitsAreUndone) {
  const Case given;
  registration::Registered found = given.result();
  found.face_from_scan.rotation = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  found.face_from_scan.translation = {5, -3, 40};
  // Scan in centimetres, raised by 0.02 cm: cleaning made millimetres of it, registration the face frame.
  Points raised = 10.0 * given.mesh.positions;
  raised.col(2).array() += 0.2;
  found.mesh.positions = transformed(found.face_from_scan, raised);
  const Distances distances = measure(given.truth, found, given.all, 10.0);
  EXPECT_NEAR(quantile(distances.vertex, 0.5), 0.02, 1e-6);
  EXPECT_NEAR(mean(distances.surface), 0.02, 1e-5);
}

TEST(Measure, PlacesSpreadByArea) {
  Mesh mesh;
  mesh.topology = Topology::from_triangles(6, Triangles{{0, 1, 2}, {3, 4, 5}});
  mesh.positions = Points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {10, 0, 0}, {13, 0, 0}, {10, 3, 0}};  // areas 0.5 and 4.5
  const Points places = surface_places(mesh, {0, 1}, 10'000, 1);
  const double in_first = static_cast<double>((places.col(0).array() < 5).count()) / 10'000;
  EXPECT_NEAR(in_first, 0.1, 0.01);  // binomial: deviation 0.003
  // Evenly inside: the mean is the triangle's centre (11, 1).
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < places.rows(); ++i)
    if (places(i, 0) > 5) sum += places.row(i).transpose();
  EXPECT_NEAR(sum.x() / (0.9 * 10'000), 11.0, 0.3);
  EXPECT_NEAR(sum.y() / (0.9 * 10'000), 1.0, 0.05);
}

TEST(Measure, ScanCountsOnlyWhereItIsDataOfTheFace) {
  const Case given;
  scan::CleanScan cleaned;
  cleaned.mesh.topology = Topology::from_triangles(7, Triangles{{0, 1, 2}, {3, 4, 5}});
  cleaned.mesh.positions = Points{{2, 2, 0.1}, {3, 2, 0.1}, {2, 3, 0.1}, {5, 5, 1}, {6, 5, 1}, {5, 6, 1}, {4, 4, 9}};
  cleaned.invented = {false, true};
  const auto distances = scan_distances(cleaned, given.result(), given.all);
  ASSERT_EQ(distances.size(), 3U);  // the second triangle is invented, the last vertex too far to be the face
  EXPECT_NEAR(mean(distances), 0.1, 1e-6);
  std::vector<bool> upper_half = given.all;
  for (int v = 0; v < 55; ++v) upper_half[v] = false;
  EXPECT_TRUE(scan_distances(cleaned, given.result(), upper_half).empty());
}

TEST(Measure, TurnedTrianglesAreCounted) {
  const Case given;
  Points folded = given.mesh.positions;
  folded(60, 0) += 2.5;  // past its neighbours
  EXPECT_EQ(turned_triangles(*given.mesh.topology, given.all, given.mesh.positions, given.mesh.positions), 0);
  EXPECT_GE(turned_triangles(*given.mesh.topology, given.all, folded, given.mesh.positions), 2);
}

TEST(Measure, SealedStaysSealedAndOpenOpen) {
  EXPECT_TRUE((Opening{"lips", 0.2, 0.9}).right());
  EXPECT_FALSE((Opening{"lips", 0.2, 1.2}).right());
  EXPECT_TRUE((Opening{"lips", 1.2, 1.9, 1.0}).right());
  EXPECT_TRUE((Opening{"lips", 20.0, 15.0}).right());
  EXPECT_FALSE((Opening{"lips", 20.0, 6.0}).right());
}

TEST(Measure, OpeningsAreThoseOfTheRimsThatTouch) {
  registration::Template head;
  head.ibug68.emplace().fill(-1);
  for (const auto& [point, vertex] : {std::pair(61, 0), {62, 1}, {63, 2}, {67, 3}, {66, 4}, {65, 5}})
    (*head.ibug68)[point] = vertex;
  Points truth = Points::Zero(8, 3), found = truth;
  truth.row(6).y() = 0.1;  // the contact, before the scheme's points
  found.row(6).y() = 4.0;
  found.topRows(3).col(1).setConstant(2.0);
  const auto by_scheme = openings(head, truth, found);
  ASSERT_EQ(by_scheme.size(), 1);  // it names no lids
  EXPECT_EQ(by_scheme[0].found, 2.0);
  head.rims = {{"lips", {{6, 7}}}};
  const auto by_rims = openings(head, truth, found);
  ASSERT_EQ(by_rims.size(), 1);
  EXPECT_EQ(by_rims[0].truly, 0.1);
  EXPECT_EQ(by_rims[0].found, 4.0);
  EXPECT_FALSE(by_rims[0].right());
}

TEST(Measure, AnotherTopologyIsRefused) {
  Case given;
  given.truth.vertices.conservativeResize(7, 3);
  EXPECT_THROW(measure(given.truth, given.result(), given.all, 1.0), InputError);
}

}  // namespace
}  // namespace vultus::apps::bench
