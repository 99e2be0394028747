#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "apps/bench_registration/leak.h"
#include "apps/bench_registration/resample.h"
#include "core/error.h"
#include "core/neighbours.h"
#include "core/rays.h"
#include "register/subdivide.h"
#include "register/template_head.h"

namespace vultus::apps::bench {
namespace {

Mesh head_surface() {
  const registration::Template head = registration::template_head();
  const registration::LoopSubdivision loop(head.topology, head.subdivisions);
  return {loop.refined(), loop(head.neutral), {}, {}};
}

ResampleOptions quick() {
  ResampleOptions options;
  options.triangles = 60'000;
  return options;
}

Points seen(const ResampledScan& scan, const Mesh& surface) {
  Points places(static_cast<Eigen::Index>(scan.places.size()), 3);
  for (std::size_t v = 0; v < scan.places.size(); ++v)
    places.row(static_cast<Eigen::Index>(v)) =
        scan.scan_from_surface * position_of(scan.places[v], *surface.topology, surface.positions);
  return places;
}

TEST(Resample, NoiseIsWhatWasAsked) {
  const Mesh surface = head_surface();
  ResampleOptions options = quick();
  const ResampledScan scan = resample(surface, surface.topology->set("face"), options);
  const Eigen::VectorXd off = (scan.mesh.positions - seen(scan, surface)).rowwise().norm();
  // Root mean square of 30,000 samples of a normal deviate: good to half a per cent; two are allowed.
  EXPECT_NEAR(std::sqrt(off.squaredNorm() / static_cast<double>(off.size())), options.noise, 0.02 * options.noise);
  options.noise = 0.0;
  const ResampledScan clean = resample(surface, surface.topology->set("face"), options);
  EXPECT_LT((clean.mesh.positions - seen(clean, surface)).rowwise().norm().maxCoeff(), 1e-3);  // rays in float
}

TEST(Resample, CoversTheFaceWithTrianglesThatFaceOutwards) {
  const Mesh surface = head_surface();
  ResampleOptions options;
  options.triangles = 200'000;
  options.holes = 0.0;
  const ResampledScan scan = resample(surface, surface.topology->set("face"), options);
  const auto triangles = scan.mesh.topology->triangles().rows();
  EXPECT_NEAR(static_cast<double>(triangles), options.triangles, 0.06 * options.triangles);
  const std::vector<bool> measured = measured_vertices(*surface.topology, surface.positions, "face");
  const Truth truth{surface, {}, transformed(scan.scan_from_surface, surface.positions)};
  // Samples are 1 mm apart at this density; what has none within 1.5 mm lies in folds at nose, lids and lips.
  EXPECT_GT(leak(truth, *surface.topology, measured, scan.mesh.positions).covered, 0.97);

  const Points normals = triangle_normals(*scan.mesh.topology, scan.mesh.positions);
  const Points true_normals = triangle_normals(*surface.topology, surface.positions);
  int outwards = 0;
  for (Eigen::Index t = 0; t < triangles; ++t) {
    const int corner = scan.mesh.topology->triangles()(t, 0);
    const Eigen::Vector3d normal =
        scan.scan_from_surface.rotation * true_normals.row(scan.places[corner].triangle).transpose();
    outwards += normals.row(t).dot(normal) > 0.0;
  }
  EXPECT_GT(static_cast<double>(outwards) / static_cast<double>(triangles), 0.99);
}

TEST(Resample, HolesTakeTheirShare) {
  const Mesh surface = head_surface();
  ResampleOptions options = quick();
  options.holes = 0.0;
  const auto whole = resample(surface, surface.topology->set("face"), options).mesh.positions.rows();
  options.holes = 0.2;
  const auto pierced = resample(surface, surface.topology->set("face"), options).mesh.positions.rows();
  // Both are as dense as it takes to come out at the number of triangles; the grid grows by the holes' share.
  EXPECT_NEAR(static_cast<double>(pierced) / static_cast<double>(whole), 1.0, 0.02);
  options.noise = 0.0;
  const ResampledScan scan = resample(surface, surface.topology->set("face"), options);
  const Truth truth{surface, {}, transformed(scan.scan_from_surface, surface.positions)};
  const std::vector<bool> measured = measured_vertices(*surface.topology, surface.positions, "face");
  const double covered = leak(truth, *surface.topology, measured, scan.mesh.positions).covered;
  EXPECT_GT(covered, 0.75);  // holes of 3 to 6 mm keep some vertices within 1.5 mm of their rims
  EXPECT_LT(covered, 0.93);
}

// A wall with a slit across, and another wall 20 mm behind it.
ResampledScan slit_scan(double width) {
  Mesh surface;
  const double half = 0.5 * width;
  surface.topology =
      Topology::from_triangles(12, Triangles{{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}, {8, 9, 10}, {8, 10, 11}});
  surface.positions =
      Points{{-60, -90, 0}, {60, -90, 0}, {60, -half, 0},  {-60, -half, 0}, {-60, half, 0}, {60, half, 0},
             {60, 90, 0},   {-60, 90, 0}, {-60, -90, -20}, {60, -90, -20},  {60, 90, -20},  {-60, 90, -20}};
  ResampleOptions options;
  options.triangles = 30'000;  // about 1 mm apart
  options.holes = options.noise = options.max_rotation = options.max_shift = 0.0;
  return resample(surface, {0, 1, 2, 3, 4, 5, 6, 7}, options);
}

// Length along the slit that is bridged, as a share of the wall's width.
double bridged(const ResampledScan& scan) {
  double sum = 0.0;
  const Triangles& triangles = scan.mesh.topology->triangles();
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Points corners = scan.mesh.positions(triangles.row(t), Eigen::all);
    if (corners.col(2).minCoeff() < -1.0 || corners.col(1).minCoeff() > 0.0 || corners.col(1).maxCoeff() < 0.0)
      continue;
    // A strip's triangles come in pairs of the same width.
    sum += 0.5 * (corners.col(0).maxCoeff() - corners.col(0).minCoeff());
  }
  return sum / 120.0;
}

TEST(Resample, NarrowSlitsGrowTogetherAndWideOnesStayOpen) {
  EXPECT_GT(bridged(slit_scan(0.8)), 0.85);
  EXPECT_EQ(bridged(slit_scan(15.0)), 0.0);
}

TEST(Resample, HasNoVerticesWhereTheSurfaceHasThem) {
  const Mesh surface = head_surface();
  const ResampledScan scan = resample(surface, surface.topology->set("face"), quick());
  const Truth truth{surface, {}, transformed(scan.scan_from_surface, surface.positions)};
  const std::vector<bool> measured = measured_vertices(*surface.topology, surface.positions, "face");
  const Leak found = leak(truth, *surface.topology, measured, scan.mesh.positions);
  // Medians over some 10,000 vertices scatter by 1 %.
  EXPECT_NEAR(found.ratio(), 1.0, 0.05);

  // A scan that has kept half the surface's own vertices gives itself away.
  Points leaking(scan.mesh.positions.rows() + surface.positions.rows() / 2, 3);
  leaking.topRows(scan.mesh.positions.rows()) = scan.mesh.positions;
  for (Eigen::Index v = 0; v < surface.positions.rows() / 2; ++v)
    leaking.row(scan.mesh.positions.rows() + v) = truth.vertices.row(2 * v);
  EXPECT_LT(leak(truth, *surface.topology, measured, leaking).ratio(), 0.7);
}

TEST(Resample, IsTheSameWhateverTheThreads) {
  const Mesh surface = head_surface();
  const ResampledScan many = resample(surface, surface.topology->set("face"), quick());
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const ResampledScan single = resample(surface, surface.topology->set("face"), quick());
  EXPECT_EQ(many.mesh.positions, single.mesh.positions);
  EXPECT_EQ(many.mesh.topology->triangles(), single.mesh.topology->triangles());
  ResampleOptions other = quick();
  other.seed = 2;
  EXPECT_NE(resample(surface, surface.topology->set("face"), other).mesh.positions.rows(), 0);
  EXPECT_FALSE(resample(surface, surface.topology->set("face"), other)
                   .scan_from_surface.rotation.isApprox(many.scan_from_surface.rotation, 1e-3));
}

TEST(Resample, RefusesWhatItCannotScan) {
  const Mesh surface = head_surface();
  ResampleOptions options;
  options.holes = 0.9;
  EXPECT_THROW(resample(surface, surface.topology->set("face"), options), UsageError);
  Mesh crumb;
  crumb.topology = Topology::from_triangles(3, Triangles{{0, 1, 2}});
  crumb.positions = Points{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}};
  EXPECT_THROW(resample(crumb, {0, 1, 2}, {}), InputError);
}

}  // namespace
}  // namespace vultus::apps::bench
