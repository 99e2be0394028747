#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/neighbours.h"
#include "core/random.h"
#include "scan/clean.h"

namespace vultus::scan {
namespace {

// A sphere of radius 100 with `rings` × 2·`rings` quads cut into triangles, open at both poles.
struct RawScan {
  std::vector<Eigen::RowVector3d> points;
  std::vector<Eigen::RowVector3i> triangles;
  Mesh mesh() const {
    Mesh result;
    Triangles t(triangles.size(), 3);
    for (std::size_t i = 0; i < triangles.size(); ++i) t.row(i) = triangles[i];
    result.topology = Topology::from_triangles(static_cast<int>(points.size()), t);
    result.positions.resize(points.size(), 3);
    for (std::size_t i = 0; i < points.size(); ++i) result.positions.row(i) = points[i];
    return result;
  }
};

RawScan band(int rings) {
  RawScan raw;
  const int around = 2 * rings;
  Random random(7);
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j < around; ++j) {
      const double theta = 0.3 + (M_PI - 0.6) * i / rings, phi = 2 * M_PI * j / around;
      const double radius = 100 + 0.05 * random.normal();
      raw.points.push_back({radius * std::sin(theta) * std::sin(phi), radius * std::cos(theta),
                            radius * std::sin(theta) * std::cos(phi)});
    }
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < around; ++j) {
      const int a = i * around + j, b = i * around + (j + 1) % around, c = a + around, d = b + around;
      raw.triangles.push_back({a, c, b});
      raw.triangles.push_back({b, c, d});
    }
  return raw;
}

TEST(CleanScan, LeavesASoundScanAlone) {
  const RawScan raw = band(40);
  const CleanScan clean = clean_scan(raw.mesh());
  EXPECT_EQ(clean.report.vertices_after, static_cast<int>(raw.points.size()));
  EXPECT_EQ(clean.report.triangles_after, static_cast<int>(raw.triangles.size()));
  EXPECT_EQ(clean.report.open_boundaries, 2);  // both poles
  EXPECT_EQ(clean.report.units.name, "mm");
  EXPECT_EQ(clean.removed.rows(), 0);
}

TEST(CleanScan, RemovesWhatIsBroken) {
  RawScan raw = band(40);
  const int sound_vertices = static_cast<int>(raw.points.size());
  const int sound_triangles = static_cast<int>(raw.triangles.size());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  raw.points.push_back({nan, 0, 0});  // hangs on one extra triangle
  raw.triangles.push_back({0, 1, sound_vertices});
  raw.points.push_back(raw.points[5]);                  // repeats vertex 5
  raw.triangles.push_back({5, 6, sound_vertices + 1});  // has no area once both are one
  raw.triangles.push_back(raw.triangles[10]);           // twice
  for (int k = 0; k < 3; ++k) raw.points.push_back({300.0 + k, 10.0 * k, k == 2 ? 5.0 : 0.0});
  raw.triangles.push_back({sound_vertices + 2, sound_vertices + 3, sound_vertices + 4});  // stray
  const CleanReport report = clean_scan(raw.mesh()).report;
  EXPECT_EQ(report.non_finite_vertices, 1);
  EXPECT_EQ(report.duplicate_vertices, 1);
  EXPECT_EQ(report.degenerate_triangles, 1);
  EXPECT_EQ(report.duplicate_triangles, 1);
  EXPECT_EQ(report.stray_components, 1);
  EXPECT_EQ(report.stray_triangles, 1);
  EXPECT_EQ(report.vertices_after, sound_vertices);
  EXPECT_EQ(report.triangles_after, sound_triangles);
}

TEST(CleanScan, TakesSpikesOffAndKeepsTheReliefOfTheScan) {
  RawScan raw = band(60);
  const int spike = 30 * 120 + 17;
  raw.points[spike] *= 1.3;  // 30 mm out of a surface with 4 mm edges
  const CleanScan clean = clean_scan(raw.mesh());
  EXPECT_GE(clean.report.spike_vertices, 1);
  EXPECT_LE(clean.report.spike_vertices, 7);  // the spike and at most the ring it pulls at
  EXPECT_LT(clean.mesh.positions.rowwise().norm().maxCoeff(), 102.0);
  EXPECT_GE(clean.removed.rows(), 1);
}

TEST(CleanScan, TakesOutACrumpledTuftAndLeavesAFold) {
  RawScan raw = band(60);
  const int around = 120;
  Random random(5);
  std::vector<int> tuft;
  for (int i = 20; i < 27; ++i)
    for (int j = 40; j < 47; ++j) {
      tuft.push_back(i * around + j);
      for (int k = 0; k < 3; ++k) raw.points[tuft.back()][k] += 6.0 * random.normal();  // over edges of 4 and 5 mm
    }
  // A crease as sharp as lips have: a groove of 3 mm on two rows, which must stay.
  for (int j = 0; j < around; ++j) raw.points[40 * around + j] *= 0.97;
  CleanOptions options;
  options.spike_factor = 1e9;  // clutter alone
  const CleanReport report = clean_scan(raw.mesh(), options).report;
  EXPECT_GE(report.clutter_vertices + report.vertices_before - report.vertices_after, 25);
  EXPECT_LE(report.vertices_before - report.vertices_after, 49 + 32);  // the tuft and the ring around it
  options.wildness = 1.0;
  EXPECT_EQ(clean_scan(raw.mesh(), options).report.vertices_after, report.vertices_before);
}

TEST(CleanScan, TakesSpikesOffABorderAndShredsAway) {
  RawScan raw = band(40);
  const int vertices = static_cast<int>(raw.points.size()), triangles = static_cast<int>(raw.triangles.size());
  // A horn of two sheets on the rim of the upper pole, 60 mm high where edges are 6 mm long.
  raw.points.push_back({5, 160, 30});
  raw.triangles.push_back({1, 0, vertices});
  raw.triangles.push_back({2, 1, vertices});
  // A strand, 1 mm wide and 80 mm long: more area than a flying point but hardly any inside.
  for (int k = 0; k <= 10; ++k) {
    raw.points.push_back({150, 8.0 * k, 0});
    raw.points.push_back({151, 8.0 * k, 0});
    if (k == 0) continue;
    const int a = vertices + 2 * k - 1;
    raw.triangles.push_back({a, a + 1, a + 3});
    raw.triangles.push_back({a, a + 3, a + 2});
  }
  CleanOptions options;
  options.smallest_component = 1e-6;
  const CleanScan clean = clean_scan(raw.mesh(), options);
  EXPECT_EQ(clean.report.stray_components, 1);
  EXPECT_LT(clean.mesh.positions.rowwise().norm().maxCoeff(), 101.0);
  EXPECT_GE(clean.report.vertices_after, vertices - 3);  // the horn may take its foot along
  EXPECT_GE(clean.report.triangles_after, triangles - 12);
}

TEST(CleanScan, TurnsAnInsideOutScanAndCountsHeads) {
  RawScan raw = band(40);
  EXPECT_FALSE(clean_scan(raw.mesh()).report.turned_inside_out);
  for (auto& triangle : raw.triangles) std::swap(triangle[0], triangle[1]);
  const CleanScan turned = clean_scan(raw.mesh());
  EXPECT_TRUE(turned.report.turned_inside_out);
  const Points normals = triangle_normals(*turned.mesh.topology, turned.mesh.positions);
  for (int t = 0; t < normals.rows(); ++t)
    EXPECT_GT(normals.row(t).dot(turned.mesh.positions.row(turned.mesh.topology->triangles()(t, 0))), 0.0);
  EXPECT_EQ(turned.report.other_heads, 0);
  const int count = static_cast<int>(raw.points.size());
  for (int v = 0; v < count; ++v) raw.points.push_back(raw.points[v] + Eigen::RowVector3d(300, 0, 0));
  for (int t = static_cast<int>(raw.triangles.size()) - 1; t >= 0; --t)
    raw.triangles.push_back(raw.triangles[t].array() + count);
  EXPECT_EQ(clean_scan(raw.mesh()).report.other_heads, 1);
}

TEST(CleanScan, TurnsTrianglesToOneSideAndSplitsSheets) {
  RawScan raw = band(40);
  for (std::size_t t = 0; t < raw.triangles.size(); t += 7) std::swap(raw.triangles[t][0], raw.triangles[t][1]);
  // A fin on an inner edge gives that edge three sides.
  const Eigen::RowVector3i base = raw.triangles[1000];
  raw.points.push_back(1.05 * raw.points[base[0]]);
  raw.triangles.push_back({base[0], base[1], static_cast<int>(raw.points.size()) - 1});
  CleanOptions options;
  options.smallest_component = 0.0;
  options.spike_factor = 1e9;
  options.wildness = 1.0;
  const Mesh mesh = clean_scan(raw.mesh(), options).mesh;
  std::vector<std::pair<int, int>> directed;
  const Triangles& triangles = mesh.topology->triangles();
  for (int t = 0; t < triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k) directed.emplace_back(triangles(t, k), triangles(t, (k + 1) % 3));
  std::sort(directed.begin(), directed.end());
  EXPECT_EQ(std::adjacent_find(directed.begin(), directed.end()), directed.end());
}

TEST(CleanScan, FillsHolesOnlyWhenAskedAndMarksThem) {
  RawScan raw = band(40);
  raw.triangles.erase(raw.triangles.begin() + 2000, raw.triangles.begin() + 2010);
  const CleanScan open = clean_scan(raw.mesh());
  EXPECT_EQ(open.report.open_boundaries, 3);
  EXPECT_EQ(open.report.holes_filled, 0);
  CleanOptions options;
  options.largest_filled_hole = 150.0;  // mm: the poles' rims are 186 mm long
  const CleanScan filled = clean_scan(raw.mesh(), options);
  EXPECT_EQ(filled.report.holes_filled, 1);
  EXPECT_EQ(filled.report.open_boundaries, 2);
  EXPECT_GE(filled.report.invented_triangles, 10);
  EXPECT_EQ(std::count(filled.invented.begin(), filled.invented.end(), true), filled.report.invented_triangles);
  // The fill continues the sphere: within 1 mm, where a flat lid over 5 cells of 6 mm would lie 0.9 mm deep.
  EXPECT_GT(filled.mesh.positions.rowwise().norm().minCoeff(), 99.0);
}

TEST(CleanScan, FillsOfSeveralHolesTakeColourAndUvsFromTheirOwnRims) {
  RawScan raw = band(40);
  raw.triangles.erase(raw.triangles.begin() + 4000, raw.triangles.begin() + 4010);
  raw.triangles.erase(raw.triangles.begin() + 2000, raw.triangles.begin() + 2010);
  Mesh scan = raw.mesh();
  TopologyData data = scan.topology->data();
  scan.colours = Points::Zero(scan.positions.rows(), 3);
  scan.colours.col(1) = (scan.positions.col(1).array() > 0.0).cast<double>();  // one hole in the green half
  data.uvs.resize(scan.positions.rows(), 2);
  data.uvs << scan.colours.col(1), scan.colours.col(1);
  data.corner_uv = data.corner_vertex;
  scan.topology = Topology::make(data);
  CleanOptions options;
  options.largest_filled_hole = 150.0;
  const CleanScan filled = clean_scan(scan, options);
  ASSERT_EQ(filled.report.holes_filled, 2);
  const Triangles &triangles = filled.mesh.topology->triangles(), &uvs = filled.mesh.topology->triangle_uvs();
  for (int t = 0; t < triangles.rows(); ++t)
    for (int k = 0; k < 3 && filled.invented[t]; ++k) {
      const double side = filled.mesh.positions(triangles(t, k), 1) > 0.0;
      EXPECT_EQ(filled.mesh.colours(triangles(t, k), 1), side);
      EXPECT_EQ(filled.mesh.topology->uvs()(uvs(t, k), 0), side);
    }
}

TEST(CleanScan, DecimatesWithinTolerance) {
  CleanOptions options;
  options.target_triangles = 2000;
  const CleanScan clean = clean_scan(band(60).mesh(), options);
  EXPECT_NEAR(clean.report.triangles_after, 2000, 20);
  // A sphere of 100 mm in 2,000 triangles of 11 mm has a sagitta of 0.15 mm; noise and borders take the rest.
  EXPECT_GT(clean.mesh.positions.rowwise().norm().minCoeff(), 99.0);
}

TEST(CleanScan, KeepsUvsOnTheirCorners) {
  const Mesh plain = band(40).mesh();
  TopologyData data = plain.topology->data();
  data.uvs.resize(data.corner_vertex.size(), 2);  // each corner its own row: vertex number and corner number
  for (int c = 0; c < static_cast<int>(data.corner_vertex.size()); ++c) {
    data.corner_uv.push_back(c);
    data.uvs.row(c) << data.corner_vertex[c], c;
  }
  for (int f = 0; f < 100; ++f) {  // some faces the wrong way round, with their UVs
    std::swap(data.corner_vertex[21 * f], data.corner_vertex[21 * f + 1]);
    std::swap(data.corner_uv[21 * f], data.corner_uv[21 * f + 1]);
  }
  Mesh textured = plain;
  textured.topology = Topology::make(data);
  const Mesh clean = clean_scan(textured).mesh;
  ASSERT_TRUE(clean.topology->has_uvs());
  for (int t = 0; t < clean.topology->triangles().rows(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int named = static_cast<int>(clean.topology->uvs()(clean.topology->triangle_uvs()(t, k), 0));
      EXPECT_EQ(clean.positions.row(clean.topology->triangles()(t, k)), plain.positions.row(named));
    }
}

TEST(CleanScan, GuessesUnitsAndTakesThemAsTold) {
  RawScan raw = band(20);
  for (auto& point : raw.points) point *= 0.1;
  const CleanScan guessed = clean_scan(raw.mesh());
  EXPECT_EQ(guessed.report.units.name, "cm");
  EXPECT_NEAR(guessed.mesh.positions.rowwise().norm().mean(), 100.0, 0.1);
  CleanOptions told;
  told.mm_per_unit = 1.0;
  EXPECT_NEAR(clean_scan(raw.mesh(), told).mesh.positions.rowwise().norm().mean(), 10.0, 0.01);
  for (auto& point : raw.points) point *= 1e-5;
  EXPECT_FALSE(guess_units(raw.mesh().positions).certain);
  for (auto& point : raw.points) point *= 1e6 * 1e3;  // a thousandfold
  EXPECT_EQ(guess_units(raw.mesh().positions).mm_per_unit, 0.001);
}

TEST(CleanScan, RefusesNothingAndWrongOptions) {
  Mesh points_only;
  points_only.topology = Topology::from_triangles(3, Triangles(0, 3));
  points_only.positions = Points::Random(3, 3);
  EXPECT_THROW(clean_scan(points_only), InputError);
  RawScan broken;
  broken.points.assign(3, Eigen::RowVector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
  broken.triangles = {{0, 1, 2}};
  EXPECT_THROW(clean_scan(broken.mesh()), InputError);
  CleanOptions options;
  options.smallest_component = 2.0;
  EXPECT_THROW(clean_scan(band(10).mesh(), options), InputError);
  options = {};
  options.spike_factor = 0.0;
  EXPECT_THROW(clean_scan(band(10).mesh(), options), InputError);
}

}  // namespace
}  // namespace vultus::scan
