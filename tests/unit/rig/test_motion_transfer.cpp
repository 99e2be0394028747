#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "core/error.h"
#include "core/transform.h"
#include "rig/deformation_transfer.h"
#include "rig/feature_points.h"
#include "rig/geodesic.h"
#include "rig/motion_transfer.h"

namespace vultus::rig {
namespace {

/// A unit octahedron split `levels` times, on the sphere of `radius` mm; `turn` gives another triangulation of the same
/// sphere.
Mesh sphere(int levels, double radius, double turn = 0.0) {
  std::vector<Eigen::Vector3d> points = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<std::array<int, 3>> faces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                           {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middle;
    const auto split = [&](int a, int b) {
      const auto [entry, added] = middle.try_emplace(std::minmax(a, b), static_cast<int>(points.size()));
      if (added) points.push_back((points[a] + points[b]).normalized());
      return entry->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& [a, b, c] : faces) {
      const int ab = split(a, b), bc = split(b, c), ca = split(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    faces = finer;
  }
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(turn, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  Mesh mesh;
  mesh.positions.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i)
    mesh.positions.row(static_cast<Eigen::Index>(i)) = radius * (rotation * points[i]).transpose();
  Triangles triangles(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f)
    triangles.row(static_cast<Eigen::Index>(f)) << faces[f][0], faces[f][1], faces[f][2];
  mesh.topology = Topology::from_triangles(static_cast<int>(points.size()), triangles);
  return mesh;
}

int nearest_vertex(const Points& positions, const Eigen::Vector3d& place) {
  Eigen::Index best = 0;
  (positions.rowwise() - place.transpose()).rowwise().squaredNorm().minCoeff(&best);
  return static_cast<int>(best);
}

/// The landmarks that the scale needs and some more, at directions of a face; `radius` finds them on a sphere.
registration::Ibug68 face_on(const Points& positions, double radius) {
  registration::Ibug68 points{};
  points.fill(-1);
  const std::map<int, Eigen::Vector3d> places = {
      {36, {-0.6, 0.4, 0.7}}, {39, {-0.25, 0.4, 0.9}},  {42, {0.25, 0.4, 0.9}},  {45, {0.6, 0.4, 0.7}},
      {33, {0, -0.1, 1}},     {48, {-0.35, -0.4, 0.8}}, {54, {0.35, -0.4, 0.8}}, {8, {0, -0.85, 0.5}},
      {27, {0, 0.5, 0.85}},   {51, {0, -0.3, 0.95}},    {57, {0, -0.5, 0.85}},   {0, {-0.95, 0.2, 0.2}},
      {16, {0.95, 0.2, 0.2}}, {4, {-0.8, -0.6, 0.1}},   {12, {0.8, -0.6, 0.1}}};
  for (const auto& [point, place] : places) points[point] = nearest_vertex(positions, radius * place.normalized());
  return points;
}

TransferFace face_of(const Mesh& mesh, double radius) {
  return {mesh.topology, mesh.positions, face_on(mesh.positions, radius)};
}

/// A smooth bulge around the mouth that also slides sideways.
Points bulged(const Points& positions, double radius) {
  Points moved = positions;
  const Eigen::RowVector3d mouth = radius * Eigen::RowVector3d(0, -0.4, 0.9).normalized();
  for (Eigen::Index v = 0; v < moved.rows(); ++v) {
    const double near = std::exp(-(positions.row(v) - mouth).squaredNorm() / std::pow(0.4 * radius, 2));
    moved.row(v) += radius * near * Eigen::RowVector3d(0.08, -0.05, 0.15);
  }
  return moved;
}

double worst(const Points& a, const Points& b) { return (a - b).rowwise().norm().maxCoeff(); }

class TransferMethods : public testing::TestWithParam<TransferMethod> {
 protected:
  static TransferOptions options() {
    TransferOptions result;
    result.method = GetParam();
    return result;
  }
};

TEST_P(TransferMethods, OntoItselfTheMotionIsItself) {
  const Mesh head = sphere(4, 90.0);
  const Points pose = bulged(head.positions, 90.0);
  const MotionTransfer transfer(face_of(head, 90.0), face_of(head, 90.0), options());
  EXPECT_TRUE(transfer.same_topology());
  EXPECT_DOUBLE_EQ(transfer.scale(), 1.0);
  // The sparse solve is exact to rounding.
  EXPECT_LT(worst(transfer(pose), pose), 1e-6);
  EXPECT_LT(worst(transfer(head.positions), head.positions), 1e-6);
}

TEST_P(TransferMethods, ALargerHeadMovesMoreInProportion) {
  const Mesh head = sphere(4, 90.0);
  Mesh large = head;
  large.positions *= 1.5;
  const MotionTransfer transfer(face_of(head, 90.0), face_of(large, 135.0), options());
  EXPECT_NEAR(transfer.scale(), 1.5, 1e-12);
  EXPECT_LT(worst(transfer(bulged(head.positions, 90.0)), 1.5 * bulged(head.positions, 90.0)), 1e-6);
}

TEST_P(TransferMethods, ATurnedHeadMovesInItsOwnFrame) {
  const Mesh head = sphere(4, 90.0);
  Similarity turn;
  turn.rotation = Eigen::AngleAxisd(0.2, Eigen::Vector3d(0.3, 1.0, -0.2).normalized()).toRotationMatrix();
  turn.translation = {5, -3, 8};
  TransferFace turned = face_of(head, 90.0);
  turned.neutral = transformed(turn, head.positions);
  TransferOptions fixed = options();
  fixed.scale = 1.0;  // heights along y are measured in the face frame, which this head is not in
  const MotionTransfer transfer(face_of(head, 90.0), turned, fixed);
  EXPECT_LT(worst(transfer(bulged(head.positions, 90.0)), transformed(turn, bulged(head.positions, 90.0))), 1e-6);
}

/// Zhu §5.2: the same sphere under another triangulation must move as the formula says it does at its vertices.
TEST_P(TransferMethods, AnotherTopologyMovesAlike) {
  const Mesh source = sphere(5, 90.0), target = sphere(4, 90.0, 0.7);
  const MotionTransfer transfer(face_of(source, 90.0), face_of(target, 90.0), options());
  EXPECT_FALSE(transfer.same_topology());
  EXPECT_GT(transfer.found_share(), 0.9);
  const Points moved = transfer(bulged(source.positions, 90.0)) - target.positions;
  const Points expected = bulged(target.positions, 90.0) - target.positions;
  // The bulge is 16 mm high. Landmarks are vertices, up to half an edge (4 mm) away from where the other sphere has
  // them, which shifts and scales the motion.
  EXPECT_LT(worst(moved, expected), 2.5);
  EXPECT_LT((moved - expected).norm() / expected.norm(), 0.12);
}

INSTANTIATE_TEST_SUITE_P(Both, TransferMethods, testing::Values(TransferMethod::gradient, TransferMethod::zhu),
                         [](const auto& method) { return method.param == TransferMethod::zhu ? "zhu" : "gradient"; });

TEST(TransferScale, IsTheMeanOfFourRatios) {
  Points source = Points::Zero(68, 3), target;
  registration::Ibug68 points{};
  for (int i = 0; i < 68; ++i) points[i] = i;
  source.row(36) << -40, 30, 0;
  source.row(39) << -20, 30, 0;
  source.row(42) << 20, 30, 0;
  source.row(45) << 40, 30, 0;
  source.row(48) << -25, -30, 0;
  source.row(54) << 25, -30, 0;
  source.row(33) << 0, -10, 0;
  source.row(8) << 0, -70, 0;
  target = source;
  for (int i : {36, 39, 42, 45}) target(i, 0) *= 1.1;  // x₁
  for (int i : {48, 54}) target(i, 0) *= 1.2;          // x₂
  for (int i : {36, 39, 42, 45}) target(i, 1) = 42.0;  // y₁: 52 against 40
  target(8, 1) = -64.0;                                // y₂: 54 against 60
  const TransferScale scale = transfer_scale(source, points, target, points);
  EXPECT_NEAR(scale.eyes, 1.1, 1e-12);
  EXPECT_NEAR(scale.mouth, 1.2, 1e-12);
  EXPECT_NEAR(scale.upper, 1.3, 1e-12);
  EXPECT_NEAR(scale.lower, 0.9, 1e-12);
  EXPECT_NEAR(scale.mean(), 1.125, 1e-12);
  points[33] = -1;
  try {
    transfer_scale(source, points, target, points);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("9.15"), std::string::npos);
  }
}

/// A strip folded like a pair of lips: two flaps that lie against each other, open in one pose and closed in another.
struct Flaps {
  std::shared_ptr<const Topology> topology;
  Points open, closed;
};

Flaps flaps(double length) {
  constexpr int half = 12, depth = 6;
  Flaps result;
  std::vector<Eigen::RowVector3i> triangles;
  const auto index = [](int i, int j) { return i * depth + j; };
  result.open.resize(2 * half * depth, 3);
  result.closed.resize(2 * half * depth, 3);
  for (int i = 0; i < 2 * half; ++i)
    for (int j = 0; j < depth; ++j) {
      // From one tip to the hinge and out to the other tip.
      const bool upper = i < half;
      const double out = length * (upper ? half - 1 - i : i - half) / (half - 1.0), side = upper ? 1.0 : -1.0;
      result.open.row(index(i, j)) << j * 2.0, side * (0.6 + 0.5 * out), out;
      result.closed.row(index(i, j)) << j * 2.0, side * std::max(0.1, 0.6 - 0.2 * out), out;
      if (i + 1 == 2 * half || j + 1 == depth) continue;
      triangles.emplace_back(index(i, j), index(i, j + 1), index(i + 1, j + 1));
      triangles.emplace_back(index(i, j), index(i + 1, j + 1), index(i + 1, j));
    }
  Triangles faces(static_cast<Eigen::Index>(triangles.size()), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t) faces.row(static_cast<Eigen::Index>(t)) = triangles[t];
  result.topology = Topology::from_triangles(2 * half * depth, faces);
  return result;
}

double widest_gap(const Points& positions, int from_tip) {
  double widest = 0.0;
  for (int i = 0; i < from_tip; ++i)
    for (int j = 0; j < 6; ++j)
      widest = std::max(widest, (positions.row(i * 6 + j) - positions.row((23 - i) * 6 + j)).norm());
  return widest;
}

TEST(MotionTransfer, ClosesOnTheTargetWhatThePoseCloses) {
  const Flaps source = flaps(12.0);
  // The target's flaps stand a third further apart than the scale of 1 would close.
  Points target = source.open;
  for (Eigen::Index v = 0; v < target.rows(); ++v) target(v, 1) *= 1.35;
  TransferOptions options;
  options.scale = 1.0;
  const TransferFace from{source.topology, source.open, {}}, to{source.topology, target, {}};
  ASSERT_FALSE(contacts(*source.topology, source.closed, options.contact_mm).empty());
  const double by_contact = widest_gap(MotionTransfer(from, to, options)(source.closed), 6);
  options.method = TransferMethod::zhu;
  const double by_vectors = widest_gap(MotionTransfer(from, to, options)(source.closed), 6);
  EXPECT_GT(by_vectors, 2.0) << "scaled vectors leave the target open";
  EXPECT_LT(by_contact, 0.5) << "0.2 mm is the source's own gap";
}

TEST(MotionTransfer, WrongInputIsRefused) {
  const Mesh head = sphere(3, 90.0), other = sphere(2, 90.0);
  TransferFace blind{head.topology, head.positions, {}};
  EXPECT_THROW(MotionTransfer(blind, face_of(head, 90.0)), InputError) << "no landmarks to measure by";
  EXPECT_THROW(MotionTransfer(face_of(other, 90.0), blind), InputError) << "no landmarks in common";
  const MotionTransfer transfer(face_of(head, 90.0), face_of(head, 90.0));
  EXPECT_THROW(transfer(other.positions), InputError);
  EXPECT_THROW((void)transfer_method_named("gradeint"), UsageError);
  TransferOptions options;
  options.search_mm = 0.0;
  EXPECT_THROW(options.validate(), InputError);
}

TEST(MotionTransfer, NamesOfMpeg4StandInForTheScheme) {
  Mesh head = sphere(3, 90.0);
  const registration::Ibug68 points = face_on(head.positions, 90.0);
  TopologyData data = head.topology->data();
  for (const auto& [index, name] : mpeg4_names())
    if (points[index] >= 0) data.landmarks[name] = points[index];
  const auto named = Topology::make(std::move(data));
  const MotionTransfer transfer({named, head.positions, {}}, {named, 1.2 * head.positions, {}});
  EXPECT_NEAR(transfer.scale(), 1.2, 1e-12);
}

TEST(Geodesic, ContoursEncloseWhatIsInside) {
  const Mesh head = sphere(4, 50.0);
  const Adjacency neighbours = adjacency(*head.topology);
  std::vector<int> ring;
  for (int k = 0; k < 8; ++k) {
    const double angle = k * std::numbers::pi / 4.0;
    ring.push_back(nearest_vertex(head.positions, {30 * std::cos(angle), 30 * std::sin(angle), 40}));
  }
  const std::vector<int> contour = closed_contour(neighbours, head.positions, ring);
  const std::vector<int> seeds = {nearest_vertex(head.positions, {0, 0, 50})};
  const std::vector<int> inside = inside_contour(neighbours, contour, seeds);
  // A cap of height 10 mm on a sphere of 50 mm is a tenth of it; the contour runs along edges of some 5 mm.
  EXPECT_NEAR(static_cast<double>(inside.size()) / head.topology->vertex_count(), 0.1, 0.04);
  for (int v : inside) EXPECT_GT(head.positions(v, 2), 30.0);
}

}  // namespace
}  // namespace vultus::rig
