#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "register/deformation_graph.h"
#include "register/nonrigid.h"
#include "synthetic_surfaces.h"

namespace vultus::registration {
namespace {

const std::vector<bool>& everywhere(const Mesh& mesh) {
  static std::vector<bool> all;
  all.assign(mesh.positions.rows(), true);
  return all;
}

DeformationGraph graph_on(const Mesh& mesh, double spacing) {
  return make_graph(*mesh.topology, mesh.positions, everywhere(mesh),
                    Eigen::VectorXd::Constant(mesh.positions.rows(), spacing));
}

TEST(DeformationGraph, CoversTheSurfaceWithWeightsThatSumToOne) {
  const Mesh ball = test::bumpy_sphere(30, 0.0, 1);
  const DeformationGraph graph = graph_on(ball, 20.0);
  for (int v = 0; v < ball.positions.rows(); ++v) {
    ASSERT_LT(graph.offsets[v], graph.offsets[v + 1]);
    double sum = 0.0;
    for (int i = graph.offsets[v]; i < graph.offsets[v + 1]; ++i) sum += graph.influences[i].weight;
    EXPECT_NEAR(sum, 1.0, 1e-12);
  }
  // About one node for each disc of the spacing's radius: 4π·95² / (0.83·20²) ≈ 340.
  EXPECT_GT(graph.size(), 170);
  EXPECT_LT(graph.size(), 600);
}

TEST(DeformationGraph, RestAndRigidPosesAreExact) {
  const Mesh ball = test::bumpy_sphere(20, 0.0, 1);
  const DeformationGraph graph = graph_on(ball, 25.0);
  const Points rest = deformed(graph, GraphPose::rest(graph), ball.positions, ball.positions);
  EXPECT_LT((rest - ball.positions).cwiseAbs().maxCoeff(), 1e-9);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const Points turned = (1.2 * ball.positions * turn.transpose()).rowwise() + Eigen::RowVector3d(4, 5, 6);
  const GraphPose pose = pose_like(graph, ball.positions, turned, true);
  EXPECT_LT((deformed(graph, pose, ball.positions, ball.positions) - turned).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(DeformationGraph, DoesNotReachAcrossASlit) {
  // Two flat strips 1 mm apart that touch nowhere, as upper and lower lip do.
  Mesh lips;
  lips.positions.resize(80, 3);
  Triangles triangles(4 * 19, 3);
  for (int side : {0, 1})
    for (int i = 0; i < 20; ++i) {
      lips.positions.row(40 * side + 2 * i) << i, 1.0 * side, 0;
      lips.positions.row(40 * side + 2 * i + 1) << i, side == 0 ? -5.0 : 6.0, 0;
      if (i == 19) continue;
      const int a = 40 * side + 2 * i;
      triangles.row(2 * (19 * side + i)) << a, a + 1, a + 2;
      triangles.row(2 * (19 * side + i) + 1) << a + 1, a + 3, a + 2;
    }
  lips.topology = Topology::from_triangles(80, triangles);
  const DeformationGraph graph = graph_on(lips, 4.0);
  for (int v = 0; v < 80; ++v)
    for (int i = graph.offsets[v]; i < graph.offsets[v + 1]; ++i)
      EXPECT_EQ(graph.node_vertex[graph.influences[i].node] < 40, v < 40);
}

TEST(GraphFit, PullsAllVerticesToGivenPlaces) {
  const Mesh ball = test::bumpy_sphere(20, 0.0, 1);
  const DeformationGraph graph = graph_on(ball, 25.0);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const Points target = (ball.positions * turn.transpose()).rowwise() + Eigen::RowVector3d(2, -3, 5);
  std::vector<PointTerm> points;
  for (int v = 0; v < ball.positions.rows(); ++v) points.push_back({v, target.row(v), 1.0});
  GraphPose pose = GraphPose::rest(graph);
  GraphFit fit(graph, ball.positions);
  for (int step = 0; step < 10; ++step) fit.step(pose, {}, points, {});
  // A rigid motion costs no stiffness, so only the solver's tolerance is left.
  EXPECT_LT((deformed(graph, pose, ball.positions, ball.positions) - target).rowwise().norm().maxCoeff(), 0.02);
}

TEST(GraphFit, CarriesAStretchAlongFromAFewPlaces) {
  // One face is wider than another: what a few places say of that, all of the skin follows.
  const Mesh ball = test::bumpy_sphere(20, 0.0, 1);
  const DeformationGraph graph = graph_on(ball, 25.0);
  const Points target = ball.positions * Eigen::DiagonalMatrix<double, 3>(1.15, 1.0, 0.95);
  std::vector<PointTerm> points;
  for (int v = 0; v < ball.positions.rows(); v += 9) points.push_back({v, target.row(v), 1.0});
  GraphPose pose = GraphPose::rest(graph);
  GraphFit fit(graph, ball.positions);
  for (int step = 0; step < 10; ++step) fit.step(pose, {}, points, {});
  // An affine map costs no smoothness, so only the solver's tolerance is left; locally rigid pieces stay millimetres
  // off.
  EXPECT_LT((deformed(graph, pose, ball.positions, ball.positions) - target).rowwise().norm().maxCoeff(), 0.1);
}

TEST(NonrigidFit, TouchingRimsMeet) {
  // Two sheets 2 mm apart whose edges a scan shows closed: a sheet without a gap.
  Mesh lips, closed;
  auto strips = [](double gap) {
    Mesh mesh;
    mesh.positions.resize(160, 3);
    Triangles triangles(2 * 2 * 19 * 3, 3);
    int t = 0;
    for (int side : {0, 1})
      for (int i = 0; i < 20; ++i)
        for (int j = 0; j < 4; ++j) {
          const double y = (side == 0 ? -1.0 : 1.0) * (0.5 * gap + 4.0 * j);
          mesh.positions.row(80 * side + 4 * i + j) << 3.0 * i, y, 0;
          if (i == 19 || j == 3) continue;
          const int a = 80 * side + 4 * i + j, up = side == 0 ? 4 : 1, right = side == 0 ? 1 : 4;
          triangles.row(t++) << a, a + up, a + up + right;
          triangles.row(t++) << a, a + up + right, a + right;
        }
    mesh.topology = Topology::from_triangles(160, triangles.topRows(t));
    return mesh;
  };
  lips = strips(2.0);
  closed = strips(0.0);
  closed.positions.col(2).array() -= 0.5;
  const ScanSurface scan(closed);
  NonrigidOptions options;
  options.far_spacing = 8.0;
  const Points none(0, 3);
  NonrigidFit fit(*lips.topology, lips.positions, lips.positions, everywhere(lips), scan, none, options);
  std::vector<std::pair<int, int>> rims;
  for (int i = 0; i < 20; ++i) rims.emplace_back(4 * i, 80 + 4 * i);
  fit.anneal({{}, {}, rims}, {}, Progress::none());
  double widest = 0.0;
  for (const auto& [a, b] : rims) widest = std::max(widest, (fit.positions().row(a) - fit.positions().row(b)).norm());
  EXPECT_LT(widest, 0.1);
}

TEST(NonrigidFit, PointsPlacedByHandHold) {
  // A plane says nothing of places along it: a kept point goes where it is told, an annealed one is let go.
  Mesh sheet = test::bumpy_sphere(30, 0.0, 1);
  const ScanSurface scan(sheet);
  NonrigidOptions options;
  options.far_spacing = 20.0;
  const Points none(0, 3);
  const int vertex = 30 * 60 / 2;
  const Eigen::Vector3d from = sheet.positions.row(vertex), to = 92.0 * (from + Eigen::Vector3d(0, 6, 0)).normalized();
  auto left = [&](const Pulls& pulls) {
    NonrigidFit fit(*sheet.topology, sheet.positions, sheet.positions, everywhere(sheet), scan, none, options);
    fit.anneal(pulls, {}, Progress::none());
    return (fit.positions().row(vertex).transpose() - to).norm();
  };
  const std::vector<PointTerm> point = {{vertex, to, 1.0}};
  EXPECT_LT(left({{}, point}), 0.5 * left({point, {}}));
}

// A warp a face could undergo: smooth, some millimetres, not along normals only.
Eigen::Vector3d warped(const Eigen::Vector3d& p) {
  return p + Eigen::Vector3d(3.0 * std::sin(p.y() / 40.0), 2.5 * std::sin(p.z() / 35.0 + 1.0),
                             3.0 * std::cos(p.x() / 45.0));
}

TEST(FitNonrigid, FollowsASmoothWarpToTheSurface) {
  const Mesh model = test::bumpy_sphere(45, 0.0, 1);
  Mesh scan = test::bumpy_sphere(110, 0.0, 2);
  Random random(5);
  for (int v = 0; v < scan.positions.rows(); ++v) {
    const Eigen::Vector3d p = warped(scan.positions.row(v));
    scan.positions.row(v) = p + 0.1 * random.normal() * p.normalized();
  }
  const ScanSurface surface(scan);
  NonrigidOptions options;
  options.far_spacing = 20.0;
  const NonrigidResult result = fit_nonrigid(*model.topology, model.positions, model.positions, everywhere(model),
                                             surface, {}, Points(0, 3), options);
  EXPECT_GT(result.initial_error, 1.0);
  EXPECT_LT(result.final_error, 0.3);
  std::vector<double> to_surface, to_place;
  for (int v = 90; v < model.positions.rows() - 90; ++v) {
    const auto near = surface.rays().closest(result.positions.row(v));
    to_surface.push_back(near->distance);
    to_place.push_back((result.positions.row(v).transpose() - warped(model.positions.row(v))).norm());
  }
  std::sort(to_surface.begin(), to_surface.end());
  std::sort(to_place.begin(), to_place.end());
  // 0.1 mm of noise puts a perfect mesh 0.08 mm from the noisy scan.
  EXPECT_LT(to_surface[to_surface.size() / 2], 0.12);
  // Nothing marks places on a smooth ball, so that part of the warp's 4 mm along the surface cannot be seen.
  EXPECT_LT(to_place[to_place.size() / 2], 3.0);
}

// A level sheet of 2 mm squares, 80 mm wide; a round place of 15 mm radius in its middle is raised.
Mesh raised_sheet(double height) {
  constexpr int side = 41;
  return test::grid(side, side, [&](int c, int r) {
    const double x = 2.0 * c - side + 1, y = 2.0 * r - side + 1;
    return Eigen::Vector3d(x, y, std::hypot(x, y) < 15.0 ? height : 0.0);
  });
}

TEST(NonrigidFit, SkinFartherOffThanTwiceTheSpreadIsNotHeard) {
  const double height = 2.0;
  const Mesh model = raised_sheet(0.0), scan = raised_sheet(height);
  const ScanSurface surface(scan);
  const Points none(0, 3);
  const auto middle = [&](double spread) {
    NonrigidOptions options;
    options.far_spacing = 8.0;
    options.least_spread = spread;
    NonrigidFit fit(*model.topology, model.positions, model.positions, everywhere(model), surface, none, options);
    fit.anneal({}, {}, Progress::none());
    return fit.positions()(20 * 41 + 20, 2);
  };
  // Nine tenths of the sheet lie on the scan, so that the least spread decides: 1 mm of reach does not get there, 3 mm
  // do.
  EXPECT_LT(middle(0.5), 0.2 * height);
  EXPECT_GT(middle(1.5), 0.8 * height);
}

TEST(FitNonrigid, RefusesWrongOptions) {
  NonrigidOptions options;
  options.annealing.stages = 0;
  EXPECT_THROW(options.validate(), InputError);
  options = {};
  options.fine_spacing = -1.0;
  EXPECT_THROW(options.validate(), InputError);
  options = {};
  options.least_spread = 0.0;
  EXPECT_THROW(options.validate(), InputError);
}

}  // namespace
}  // namespace vultus::registration
