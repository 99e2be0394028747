#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/virtual_stage/scanner.h"
#include "core/error.h"
#include "core/neighbours.h"
#include "register/subdivide.h"
#include "register/template_head.h"

namespace vultus::virtual_stage {
namespace {

constexpr double radius = 90.0;  // mm

// A sphere of longitudes and latitudes.
ScanSubject ball() {
  constexpr int columns = 120, rows = 60;
  Points positions((rows + 1) * columns, 3);
  Triangles triangles(2 * rows * columns, 3);
  int t = 0;
  for (int r = 0; r <= rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const double polar = M_PI * (r + 0.001) / (rows + 0.002), turn = 2 * M_PI * c / columns;
      positions.row(r * columns + c) = radius * Eigen::RowVector3d(std::sin(polar) * std::sin(turn), std::cos(polar),
                                                                   std::sin(polar) * std::cos(turn));
      if (r == rows) continue;
      const int a = r * columns + c, b = r * columns + (c + 1) % columns;
      triangles.row(t++) = Eigen::RowVector3i(a, a + columns, b + columns);
      triangles.row(t++) = Eigen::RowVector3i(a, b + columns, b);
    }
  ScanSubject subject;
  subject.surface.topology = Topology::from_triangles(static_cast<int>(positions.rows()), triangles);
  subject.surface.positions = positions;
  subject.surface.colours = Points::Constant(positions.rows(), 3, 0.5);
  return subject;
}

ScanOptions quick() {
  ScanOptions options;
  options.triangles = 12'000;
  options.clutter = false;
  options.spikes = 0;
  return options;
}

Eigen::VectorXd errors(const Scan& scan, const ScanSubject& subject) {
  Eigen::VectorXd distance(scan.truth.size());
  for (std::size_t v = 0; v < scan.truth.size(); ++v)
    distance[v] =
        (scan.scan_from_face * position_of(scan.truth[v], *subject.surface.topology, subject.surface.positions) -
         Eigen::Vector3d(scan.mesh.positions.row(v)))
            .norm();
  return distance;
}

TEST(Scanner, NoiseIsWhatWasAsked) {
  const ScanSubject subject = ball();
  for (const double noise : {0.0, 0.05, 0.2}) {
    ScanOptions options = quick();
    options.noise = noise;
    const Scan scan = scan_subject(subject, options);
    const Eigen::VectorXd error = errors(scan, subject);
    const double rms = std::sqrt(error.squaredNorm() / static_cast<double>(error.size()));
    // Some 6,000 samples: the deviation of an estimate of σ is σ/√12,000, 1 %; four of them.
    EXPECT_NEAR(rms, noise, 0.04 * noise + 1e-9);
  }
}

TEST(Scanner, LiesOnTheSubject) {
  const ScanSubject subject = ball();
  ScanOptions options = quick();
  options.noise = 0;
  const Scan scan = scan_subject(subject, options);
  for (Eigen::Index v = 0; v < scan.mesh.positions.rows(); ++v) {
    const double r = (Eigen::Vector3d(scan.mesh.positions.row(v)) - scan.scan_from_face.translation).norm();
    EXPECT_LE(r, radius + 1e-6);
    EXPECT_GE(r, radius * std::cos(M_PI / 60) - 1e-6);  // the facets' sagitta
  }
}

TEST(Scanner, CountAndOrientation) {
  const ScanSubject subject = ball();
  const ScanOptions options = quick();
  const Scan scan = scan_subject(subject, options);
  const Topology& topology = *scan.mesh.topology;
  EXPECT_NEAR(topology.face_count(), options.triangles, 0.12 * options.triangles);
  const Points normals = triangle_normals(topology, scan.mesh.positions);
  int outward = 0;
  for (Eigen::Index t = 0; t < topology.triangles().rows(); ++t) {
    const Eigen::Vector3d corner = scan.mesh.positions.row(topology.triangles()(t, 0));
    outward += normals.row(t).dot(corner - scan.scan_from_face.translation) > 0;
  }
  EXPECT_EQ(outward, topology.face_count());
  EXPECT_EQ(scan.mesh.colours.rows(), scan.mesh.positions.rows());
}

TEST(Scanner, HeadPoseIsRigidAndBounded) {
  const ScanSubject subject = ball();
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    ScanOptions options = quick();
    options.seed = seed;
    options.triangles = 1'000;
    const Similarity pose = scan_subject(subject, options).scan_from_face;
    EXPECT_EQ(pose.scale, 1.0);
    EXPECT_LT((pose.rotation * pose.rotation.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_LE(pose.translation.cwiseAbs().maxCoeff(), options.max_translation);
    const double angle = std::acos(std::clamp(0.5 * (pose.rotation.trace() - 1), -1.0, 1.0));
    EXPECT_LE(angle, std::sqrt(3.0) * options.max_rotation + 1e-9);
    EXPECT_GT(angle, 0.0);
  }
}

TEST(Scanner, PatchesAreLost) {
  const ScanSubject subject = ball();
  ScanOptions options = quick();
  options.triangles = 30'000;  // samples closer than the patches are wide
  options.dropout = 0;
  const Scan whole = scan_subject(subject, options);
  options.dropout = 0.1;
  const Scan holed = scan_subject(subject, options);
  // The sampling is made denser by as much as will be lost, so holes show as boundary, not as fewer vertices.
  EXPECT_GT(boundary_loops(*holed.mesh.topology).size(), boundary_loops(*whole.mesh.topology).size() + 5);
}

TEST(Scanner, ClutterIsAddedAndMarked) {
  ScanSubject subject = ball();
  subject.hair = (subject.surface.positions.col(1).array() > 40).cast<double>();
  ScanOptions options = quick();
  const Scan clean = scan_subject(subject, options);
  options.clutter = true;
  const Scan cluttered = scan_subject(subject, options);
  const std::size_t seen = clean.truth.size();
  ASSERT_GT(cluttered.truth.size(), seen + 500);
  for (std::size_t v = 0; v < cluttered.truth.size(); ++v) EXPECT_EQ(cluttered.truth[v].valid(), v < seen);
  EXPECT_TRUE(cluttered.mesh.positions.topRows(seen) == clean.mesh.positions);
}

TEST(Scanner, SameBytesForAnyThreadCount) {
  const ScanSubject subject = ball();
  const ScanOptions options = quick();
  const Scan many = scan_subject(subject, options);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const Scan one = scan_subject(subject, options);
  EXPECT_TRUE(many.mesh.positions == one.mesh.positions);
  EXPECT_TRUE(many.mesh.topology->triangles() == one.mesh.topology->triangles());
  ScanOptions other = options;
  other.seed = 2;
  EXPECT_FALSE(scan_subject(subject, other).mesh.positions == one.mesh.positions);
}

TEST(Scanner, HeadScanHasItsOwnDenseTriangulation) {
  const registration::Template head = registration::template_head();
  const registration::LoopSubdivision subdivision(head.topology, 2);
  ScanSubject subject;
  subject.surface.topology = subdivision.refined();
  subject.surface.positions = subdivision(head.neutral);
  ScanOptions options;
  options.triangles = 165'000;
  const Scan scan = scan_subject(subject, options);
  EXPECT_GE(scan.mesh.topology->face_count(), 150'000);
  // 22,000 template vertices among 80,000 samples of a continuous jitter: none should fall on one by chance.
  int on_vertex = 0;
  for (const SurfacePoint& place : scan.truth) on_vertex += place.valid() && place.barycentric.maxCoeff() > 1 - 1e-6;
  EXPECT_EQ(on_vertex, 0);
}

TEST(Scanner, RefusesNonsense) {
  const ScanSubject subject = ball();
  const auto with = [](auto set) {
    ScanOptions options;
    set(options);
    return options;
  };
  EXPECT_THROW(scan_subject(subject, with([](ScanOptions& o) { o.triangles = 10; })), UsageError);
  EXPECT_THROW(scan_subject(subject, with([](ScanOptions& o) { o.noise = -1; })), UsageError);
  EXPECT_THROW(scan_subject(subject, with([](ScanOptions& o) { o.dropout = 0.9; })), UsageError);
  EXPECT_THROW(
      scan_subject(subject, with([](ScanOptions& o) { o.max_rotation = std::numeric_limits<double>::quiet_NaN(); })),
      UsageError);
  ScanSubject far = ball();
  far.surface.positions.col(0).array() += 5000;
  EXPECT_THROW(scan_subject(far, ScanOptions{}), InputError);
}

}  // namespace
}  // namespace vultus::virtual_stage
