#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "register/fill.h"
#include "register/project.h"
#include "register/scan_surface.h"
#include "register/smooth_projection.h"
#include "register/unfold.h"
#include "synthetic_surfaces.h"

namespace vultus::registration {
namespace {

// An upright cylinder of 80 mm radius and 200 mm height, open at both ends.
Mesh cylinder(double radius, int around, int rows) {
  Mesh mesh;
  mesh.positions.resize(around * (rows + 1), 3);
  for (int i = 0; i <= rows; ++i)
    for (int j = 0; j < around; ++j) {
      const double phi = 2 * M_PI * j / around;
      mesh.positions.row(i * around + j) << radius * std::sin(phi), 100.0 - 200.0 * i / rows, radius * std::cos(phi);
    }
  Triangles triangles(2 * around * rows, 3);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < around; ++j) {
      const int a = i * around + j, b = i * around + (j + 1) % around;
      triangles.row(2 * (i * around + j)) << a, a + around, b;
      triangles.row(2 * (i * around + j) + 1) << b, a + around, b + around;
    }
  mesh.topology = Topology::from_triangles(static_cast<int>(mesh.positions.rows()), triangles);
  return mesh;
}

const Eigen::Vector3d origin = Eigen::Vector3d::Zero(), up = Eigen::Vector3d::UnitY();

TEST(CylindricalProjection, GoesStraightOutToACylinder) {
  const Mesh scan = cylinder(80.0, 720, 100), inside = cylinder(76.0, 60, 20);
  const ScanSurface surface(scan);
  const std::vector<bool> all(inside.positions.rows(), true);
  const Projection result = project_cylindrically(*inside.topology, inside.positions, all, surface, origin, up);
  for (int v = 60; v < inside.positions.rows() - 60; ++v) {  // the rims touch the scan's own edge
    ASSERT_TRUE(result.hit[v]);
    const Eigen::RowVector3d expected =
        inside.positions.row(v).cwiseProduct(Eigen::RowVector3d(80.0 / 76, 1, 80.0 / 76));
    // 720 facets around: a chord lies at most 0.8 µm inside the circle.
    EXPECT_LT((result.positions.row(v) - expected).norm(), 2e-3);
  }
}

TEST(CylindricalProjection, KeepsToTheLimitAndFillsSmoothly) {
  const Mesh scan = cylinder(80.0, 360, 50);
  Mesh inside = cylinder(76.0, 60, 20);
  std::vector<int> dented;
  for (int v = 0; v < inside.positions.rows(); ++v)
    if (inside.positions(v, 2) > 70 && std::abs(inside.positions(v, 1)) < 35) {
      inside.positions(v, 0) *= 0.8;
      inside.positions(v, 2) *= 0.8;
      dented.push_back(v);
    }
  ASSERT_FALSE(dented.empty());
  const ScanSurface surface(scan);
  const std::vector<bool> all(inside.positions.rows(), true);
  ProjectOptions options;
  options.max_displacement = 10.0;  // the dent is some 19 mm away
  const Projection result =
      project_cylindrically(*inside.topology, inside.positions, all, surface, origin, up, options);
  for (int v : dented) {
    EXPECT_FALSE(result.hit[v]);
    // Displacements around are 4 mm outward; a harmonic fill stays within them.
    EXPECT_NEAR((result.positions.row(v) - inside.positions.row(v)).norm(), 4.0, 0.4);
  }
}

TEST(NormalProjection, GoesOutToASphere) {
  const auto radius = [](double r) { return [r](const Eigen::Vector3d&) { return r; }; };
  const Mesh scan = test::radial_grid(120, 0.0, 5, radius(80.0)), inside = test::radial_grid(30, 0.0, 6, radius(77.0));
  const ScanSurface surface(scan);
  const std::vector<bool> all(inside.positions.rows(), true);
  const Projection result = project_along_normals(*inside.topology, inside.positions, all, surface);
  for (int v = 60; v < inside.positions.rows() - 60; ++v) {
    ASSERT_TRUE(result.hit[v]);
    EXPECT_NEAR(result.positions.row(v).norm(), 80.0, 0.06);  // sagitta of the scan's 4 mm triangles
  }
}

TEST(Projection, AsksSurfacesToFaceTheSameWay) {
  const Mesh scan = cylinder(80.0, 360, 50);
  Mesh inside_out = cylinder(78.0, 60, 20);
  Triangles turned = inside_out.topology->triangles();
  turned.col(0).swap(turned.col(1));
  inside_out.topology = Topology::from_triangles(static_cast<int>(inside_out.positions.rows()), turned);
  const ScanSurface surface(scan);
  const std::vector<bool> all(inside_out.positions.rows(), true);
  const Projection result = project_cylindrically(*inside_out.topology, inside_out.positions, all, surface, origin, up);
  EXPECT_EQ(std::count(result.hit.begin(), result.hit.end(), true), 0);
  EXPECT_EQ(result.positions, inside_out.positions);
  ProjectOptions options;
  options.max_displacement = 0.0;
  EXPECT_THROW(project_cylindrically(*scan.topology, scan.positions, std::vector<bool>(scan.positions.rows(), true),
                                     surface, origin, up, options),
               InputError);
}

TEST(ScanSurface, BordersAndInventedTrianglesAreNoData) {
  const Mesh scan = cylinder(80.0, 120, 20);
  const ScanSurface plain(scan);
  const Eigen::Vector3d outward = Eigen::Vector3d::UnitZ();
  EXPECT_TRUE(plain.nearest({0, 0, 82}, outward, 5.0, 0.5));
  EXPECT_FALSE(plain.nearest({0, 103, 82}, outward, 5.0, 0.5));  // nearest to the rim
  EXPECT_FALSE(plain.nearest({0, 0, 82}, -outward, 5.0, 0.5));
  EXPECT_FALSE(plain.nearest({0, 0, 88}, outward, 5.0, 0.5));
  const ScanSurface invented(scan, std::vector<bool>(scan.topology->triangles().rows(), true));
  EXPECT_FALSE(invented.nearest({0, 0, 82}, outward, 5.0, 0.5));
}

TEST(SmoothProjection, ReachesTheSurfaceBeneathTheNoise) {
  const auto ball = [](const Eigen::Vector3d&) { return 80.0; };
  const Mesh scan = test::radial_grid(150, 0.1, 8, ball);
  Mesh near = test::radial_grid(40, 0.5, 9, ball);
  const ScanSurface surface(scan);
  const std::vector<bool> all(near.positions.rows(), true);
  const Points result = project_smoothly(*near.topology, near.positions, all, surface);
  double sum = 0.0;
  int count = 0;
  for (int v = 160; v < near.positions.rows() - 160; ++v, ++count) sum += std::abs(result.row(v).norm() - 80.0);
  // 0.5 mm of own noise goes; of the scan's 0.1 mm less than that stays, as each offset leans on its neighbours. The
  // middles of 6 mm edges lie 0.06 mm inside, so vertices settle that much outside.
  EXPECT_LT(sum / count, 0.09);
}

TEST(Fill, IsHarmonicAlongAStrip) {
  // A strip of quads: with both ends known, the fill must rise evenly.
  const int n = 11;
  TopologyData data;
  data.vertex_count = 2 * n;
  data.face_offsets.push_back(0);
  for (int i = 0; i + 1 < n; ++i) {
    for (int v : {2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1}) data.corner_vertex.push_back(v);
    data.face_offsets.push_back(static_cast<int>(data.corner_vertex.size()));
  }
  const auto strip = Topology::make(data);
  Points positions(2 * n, 3), displacements = Points::Zero(2 * n, 3);
  std::vector<bool> known(2 * n, false);
  for (int i = 0; i < n; ++i) {
    positions.row(2 * i) << i, 0, 0;
    positions.row(2 * i + 1) << i, 1, 0;
  }
  for (int v : {0, 1, 2 * n - 2, 2 * n - 1}) known[v] = true;
  displacements.bottomRows(2).col(1).setConstant(10.0);
  const Points filled = fill_smoothly(*strip, positions, displacements, known);
  for (int i = 0; i < n; ++i) EXPECT_NEAR(filled(2 * i, 1), i, 1e-9);
}

TEST(Fill, PiecesWithoutDataMoveAsOneBody) {
  Mesh skin = test::bumpy_sphere(30, 0.0, 1);
  // A small tetrahedron inside is an eyeball of its own.
  TopologyData data = skin.topology->data();
  const int first = data.vertex_count;
  data.vertex_count += 4;
  for (const auto& face : {std::array{0, 2, 1}, std::array{0, 1, 3}, std::array{1, 2, 3}, std::array{2, 0, 3}}) {
    for (int v : face) data.corner_vertex.push_back(first + v);
    data.face_offsets.push_back(static_cast<int>(data.corner_vertex.size()));
  }
  for (int v = first; v < first + 4; ++v) data.sets["eyeball_left"].push_back(v);
  const auto topology = Topology::make(data);
  Points rest(first + 4, 3);
  rest.topRows(first) = skin.positions;
  rest.bottomRows(4) << 0, 0, 70, 5, 0, 70, 0, 5, 70, 0, 0, 75;
  const std::vector<bool> fitted = fitted_vertices(*topology);
  EXPECT_FALSE(fitted[first]);
  EXPECT_TRUE(fitted[0]);
  Points moved = rest;
  moved.topRows(first).rowwise() += Eigen::RowVector3d(3, 1, 2);
  carry_components(*topology, rest, fitted, false, moved);
  const Points shifted = rest.bottomRows(4).rowwise() + Eigen::RowVector3d(3, 1, 2);
  EXPECT_LT((moved.bottomRows(4) - shifted).norm(), 1e-6);
}

// `columns` by 21 vertices, `spacing` mm apart along x and 1 mm along y, at `height(x)`.
template <typename Height>
Mesh sheet(int columns, double spacing, Height height) {
  return test::grid(columns, 21, [&](int c, int r) {
    const double x = spacing * (c - 0.5 * (columns - 1));
    return Eigen::Vector3d(x, r - 10.0, height(x));
  });
}

TEST(SmoothProjection, OffsetsDieAwayWhereTheDataEnds) {
  const Mesh mesh = sheet(41, 1.0, [](double) { return 0.0; });
  Mesh scan = sheet(161, 0.25, [](double x) { return 0.5 + 0.04 * (x + 20.0); });
  std::vector<bool> keep(scan.positions.rows());
  for (std::size_t v = 0; v < keep.size(); ++v) keep[v] = scan.positions(v, 0) < 0.0;
  scan = sub_mesh(scan, keep).mesh;
  const std::vector<bool> all(mesh.positions.rows(), true);
  const Points result = project_smoothly(*mesh.topology, mesh.positions, all, ScanSurface(scan));
  for (int v = 0; v < result.rows(); ++v) {
    if (std::abs(result(v, 1)) > 8.0) continue;
    if (result(v, 0) > -18.0 && result(v, 0) < -4.0) {
      EXPECT_NEAR(result(v, 2), 0.5 + 0.04 * (result(v, 0) + 20.0), 0.1);
    }
    EXPECT_LT(result(v, 2), 1.4);  // the data's highest place, 1.3, and no slope run on
    if (result(v, 0) > 10.0) {
      EXPECT_NEAR(result(v, 2), 0.0, 0.1);
    }
  }
}

// The bottom of the groove bends more sharply than the way to the scan is long: offsets along normals cross there.
TEST(SmoothProjection, AGrooveDoesNotFoldOver) {
  auto groove = [](double x) { return 2.0 * std::sqrt(x * x + 0.01); };
  const Mesh mesh = sheet(81, 0.1, groove), scan = sheet(161, 0.05, [&](double x) { return groove(x) + 1.5; });
  const std::vector<bool> all(mesh.positions.rows(), true);
  const Points result = project_smoothly(*mesh.topology, mesh.positions, all, ScanSurface(scan));
  const auto folded = folded_triangles(*mesh.topology, mesh.positions, result);
  EXPECT_EQ(std::count(folded.begin(), folded.end(), true), 0);
}

}  // namespace
}  // namespace vultus::registration

TEST(FittedVertices, leaves_out_what_lies_inside_by_the_names_of_sets) {
  vultus::TopologyData data;
  data.vertex_count = 7;
  data.face_offsets = {0, 3};
  data.corner_vertex = {0, 1, 2};
  data.sets = {
      {"face", {0, 1}}, {"eye_socket_left", {2}}, {"gums_tongue", {3}}, {"eyeballs", {4}}, {"eyelashes_right", {5}}};
  const std::vector<bool> expected = {true, true, false, false, false, false, true};
  EXPECT_EQ(vultus::registration::fitted_vertices(*vultus::Topology::make(data)), expected);
}
