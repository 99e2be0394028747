#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/error.h"
#include "core/neighbours.h"
#include "core/transform.h"
#include "register/control_surface.h"
#include "register/downhill_simplex.h"
#include "register/energy_registration.h"
#include "tests/unit/register/synthetic_surfaces.h"

namespace vultus::registration {
namespace {

// A square sheet of (n+1)² vertices, `size` mm wide, over z = height(x, y).
template <typename Height>
Mesh sheet(int n, double size, Height height) {
  Mesh mesh;
  mesh.positions.resize((n + 1) * (n + 1), 3);
  Triangles triangles(2 * n * n, 3);
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) {
      const double x = size * j / n, y = size * i / n;
      mesh.positions.row(i * (n + 1) + j) << x, y, height(x, y);
      if (i == n || j == n) continue;
      const int a = i * (n + 1) + j;
      triangles.row(2 * (i * n + j)) << a, a + 1, a + n + 2;
      triangles.row(2 * (i * n + j) + 1) << a, a + n + 2, a + n + 1;
    }
  mesh.topology = Topology::from_triangles(static_cast<int>(mesh.positions.rows()), triangles);
  return mesh;
}

double hill(double x, double y) { return 6.0 * std::exp(-(std::pow(x - 22.0, 2) + std::pow(y - 18.0, 2)) / 250.0); }
double flat(double, double) { return 0.0; }

Template without_names(const Mesh& mesh) {
  Template head;
  head.topology = mesh.topology;
  head.neutral = mesh.positions;
  return head;
}

/// A sheet with its bones, and a scan to register it to.
struct Case {
  Mesh mesh;
  std::vector<bool> skin;
  SkinControls controls;
  PlanarBones bones;
  Mesh target;
  ScanSurface scan;

  Case(Mesh given, Mesh goal, double spacing)
      : mesh(std::move(given)),
        skin(mesh.positions.rows(), true),
        controls(make_controls(without_names(mesh), *mesh.topology, mesh.positions, skin, {spacing, spacing, 0.0})),
        bones(controls.on(mesh.positions), mesh.positions, {}, {0.95, true}),
        target(std::move(goal)),
        scan(target) {}
  RegistrationEnergy energy(const EnergyOptions& options = {}) const {
    return RegistrationEnergy(*mesh.topology, mesh.positions, bones, skin, scan, options);
  }
};

TEST(DownhillSimplex, FindsAMinimumInACurvedValley) {
  const auto banana = [](const Eigen::VectorXd& x) {
    return 100.0 * std::pow(x[1] - x[0] * x[0], 2) + std::pow(1.0 - x[0], 2);  // Rosenbrock 1960
  };
  SimplexOptions options;
  options.least_size = 1e-8;
  options.spread = 1e-14;
  const SimplexResult found = downhill_simplex(banana, Eigen::Vector2d(-1.2, 1.0), options);
  EXPECT_TRUE(found.converged);
  EXPECT_NEAR(found.place[0], 1.0, 1e-4);
  EXPECT_NEAR(found.place[1], 1.0, 1e-4);
  EXPECT_NEAR(found.initial_value, 24.2, 1e-12);
}

TEST(DownhillSimplex, StopsWhenItsEvaluationsAreUsedUp) {
  int calls = 0;
  SimplexOptions options;
  options.most_evaluations = 40;
  const SimplexResult found = downhill_simplex(
      [&](const Eigen::VectorXd& x) {
        ++calls;
        return x.squaredNorm();
      },
      Eigen::VectorXd::Constant(6, 50.0), options);
  EXPECT_FALSE(found.converged);
  EXPECT_EQ(calls, found.evaluations);
  EXPECT_LE(calls, 40 + 8);  // the step under way may end
  EXPECT_LE(found.value, found.initial_value);
}

TEST(ControlSurface, CoversASheetEvenly) {
  const Mesh mesh = sheet(40, 60.0, flat);
  const SkinControls controls =
      make_controls(without_names(mesh), *mesh.topology, mesh.positions, std::vector<bool>(41 * 41, true), {12, 12, 0});
  EXPECT_GT(controls.vertices.size(), 25u);  // 60²/12² and the borders
  EXPECT_LT(controls.vertices.size(), 80u);
  double area = 0.0;
  const ControlSurface surface = controls.on(mesh.positions);
  for (int j = 0; j < surface.triangles.rows(); ++j) {
    const Eigen::Vector3d o = surface.rest.row(surface.triangles(j, 0)), p = surface.rest.row(surface.triangles(j, 1)),
                          q = surface.rest.row(surface.triangles(j, 2));
    const Eigen::Vector3d doubled = (p - o).cross(q - o);
    EXPECT_GT(doubled.z(), 0.0);  // turned as the sheet is
    area += 0.5 * doubled.z();
  }
  // No overlap; slivers and the strip between the border and its nearest bones are missing.
  EXPECT_LT(area, 3600.0 + 1e-6);
  EXPECT_GT(area, 0.85 * 3600.0);
}

TEST(ControlSurface, BonesDoNotSpanASlit) {
  // The sheet is cut along y = 30 from x = 10 to 50, as a mouth is, and its lips named.
  Mesh mesh = sheet(40, 60.0, flat);
  const int n = 41;
  Triangles triangles = mesh.topology->triangles();
  const int fresh = static_cast<int>(mesh.positions.rows());
  Points positions(fresh + 26, 3);
  positions.topRows(fresh) = mesh.positions;
  for (int j = 7; j <= 32; ++j) positions.row(fresh + j - 7) = mesh.positions.row(20 * n + j);
  for (int t = 2 * 40 * 20; t < triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k)
      if (const int v = triangles(t, k); v / n == 20 && v % n >= 7 && v % n <= 32) triangles(t, k) = fresh + v % n - 7;
  mesh.topology = Topology::from_triangles(static_cast<int>(positions.rows()), triangles);
  mesh.positions = positions;
  Template head = without_names(mesh);
  head.ibug68.emplace();
  head.ibug68->fill(-1);
  for (int i = 0; i < 5; ++i) {
    (*head.ibug68)[49 + i] = fresh + 3 + 5 * i;
    (*head.ibug68)[59 - i] = 20 * n + 10 + 5 * i;
  }
  const SkinControls controls =
      make_controls(head, *mesh.topology, positions, std::vector<bool>(positions.rows(), true), {10, 10, 0});
  const PlanarBones bones(controls.on(positions), positions, controls.masks, {0.95, true});
  Points control = bones.surface().rest;
  for (int c = 0; c < control.rows(); ++c) {  // what lies below the slit drops, most in its middle
    const int v = controls.vertices[c];
    if (v < fresh && positions(v, 1) <= 30.0) control(c, 1) -= 12.0 * std::sin(M_PI * positions(v, 0) / 60.0);
  }
  const Points moved = bones(control);
  for (int j = 12; j <= 27; ++j) {
    EXPECT_LT(std::abs(moved(fresh + j - 7, 1) - 30.0), 1e-9) << j;  // the upper lip stays
    EXPECT_LT(moved(20 * n + j, 1), 30.0 - 6.0) << j;                // the lower one drops
  }
}

TEST(RegistrationEnergy, RigidMotionStrainsAndBendsNothing) {
  const Case c(sheet(20, 40.0, hill), sheet(20, 40.0, flat), 9.0);
  const RegistrationEnergy energy = c.energy();
  Similarity motion;
  motion.rotation = Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, 1, 3).normalized()).toRotationMatrix();
  motion.translation << 3, 20, -8;
  const EnergyTerms rest = energy(c.bones.surface().rest), moved = energy(transformed(motion, c.bones.surface().rest));
  for (const EnergyTerms& terms : {rest, moved}) {
    EXPECT_LT(terms.strain, 1e-12);
    EXPECT_LT(terms.bending, 1e-12);
  }
}

TEST(RegistrationEnergy, StretchedPlaneIsStrainedButNotBent) {
  EnergyOptions options;
  options.softness = 0.0;
  const Case c(sheet(20, 40.0, flat), sheet(20, 40.0, flat), 9.0);
  const EnergyTerms terms = c.energy(options)(1.1 * c.bones.surface().rest);
  double mean = 0.0;
  for (const auto& [a, b] : edges(*c.mesh.topology))
    mean += (c.mesh.positions.row(a) - c.mesh.positions.row(b)).norm() / edges(*c.mesh.topology).size();
  EXPECT_LT(terms.bending, 1e-12);
  // Every edge inside a bone grows by a tenth; a few at the border lie in edge regions, which do not all grow.
  EXPECT_NEAR(terms.strain, 0.1 * mean, 0.01 * mean);
}

TEST(RegistrationEnergy, DistanceOfALiftedPlane) {
  EnergyOptions options;
  options.softness = 0.0;
  const Case c(sheet(20, 40.0, flat), sheet(20, 40.0, flat), 9.0);
  RegistrationEnergy energy = c.energy(options);
  Points control = c.bones.surface().rest;
  EXPECT_GT(energy.find_data(control, 5.0), 300);  // the border of the data is none
  control.col(2).array() += 2.0;
  EXPECT_NEAR(energy(control).distance, 2.0, 1e-5);  // Embree works in single precision
  EXPECT_EQ(energy.find_data(control, 1.0), 0);
}

TEST(RegistrationEnergy, GradientMatchesDifferences) {
  const Case c(sheet(14, 40.0, flat), sheet(30, 40.0, hill), 12.0);
  RegistrationEnergy energy = c.energy();
  Points control = c.bones.surface().rest;
  Random random(4);
  for (int i = 0; i < control.rows(); ++i)
    for (int k = 0; k < 3; ++k) control(i, k) += random.uniform(-1.5, 1.5);
  energy.find_data(control, 12.0);
  const Points gradient = energy.gradient(control);
  const double h = 1e-3;  // the closest point is known to single precision only
  double worst = 0.0;
  for (int i = 0; i < control.rows(); ++i)
    for (int k = 0; k < 3; ++k) {
      Points ahead = control, behind = control;
      ahead(i, k) += h;
      behind(i, k) -= h;
      worst = std::max(worst, std::abs((energy(ahead).total - energy(behind).total) / (2 * h) - gradient(i, k)));
    }
  EXPECT_LT(worst, 0.01 * gradient.cwiseAbs().maxCoeff());  // facets of the target bend within a step
}

TEST(EnergyRegistration, BothSolversReachTheSameMinimum) {
  const Case c(sheet(12, 40.0, flat), sheet(30, 40.0, hill), 22.0);
  ASSERT_LE(c.controls.vertices.size(), 16u);
  EnergyRegistrationOptions options;
  options.rounds = 1;
  options.tolerance = 1e-7;
  options.most_steps = 200;
  std::vector<double> totals;
  for (const EnergySolver solver : {EnergySolver::ceres, EnergySolver::simplex}) {
    options.solver = solver;
    RegistrationEnergy energy = c.energy();
    const EnergyRegistration found = minimize_energy(energy, c.bones.surface().rest, options);
    EXPECT_LT(found.final.total, 0.8 * found.initial.total);
    EXPECT_GT(found.steps, 1);
    EXPECT_NE(found.stopped.find("tolerance"), std::string::npos) << found.stopped;
    totals.push_back(found.final.total);
  }
  EXPECT_NEAR(totals[1], totals[0], 1e-3 * totals[0]);  // what ten sweeps by single points still creep
}

TEST(EnergyRegistration, WholeSimplexAsPublished) {
  const Case c(sheet(8, 40.0, flat), sheet(20, 40.0, hill), 33.0);
  ASSERT_LE(c.controls.vertices.size(), 8u);
  EnergyRegistrationOptions options;
  options.rounds = 1;
  options.tolerance = 1e-6;
  options.most_steps = 30;
  std::vector<double> totals;
  for (bool whole : {true, false}) {
    options.solver = whole ? EnergySolver::simplex : EnergySolver::ceres;
    options.whole_simplex = whole;
    RegistrationEnergy energy = c.energy();
    totals.push_back(minimize_energy(energy, c.bones.surface().rest, options).final.total);
  }
  EXPECT_NEAR(totals[0], totals[1], 5e-3 * totals[1]);  // 24 dimensions are many for one simplex
}

TEST(EnergyRegistration, BringsASurfaceOntoAnotherWithoutSliding) {
  // The truth is known: the target is the same surface moved smoothly, sampled elsewhere.
  const auto skin = [](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    return p +
           Eigen::Vector3d(1.5 * std::sin(0.04 * p.y()), 2.0 * std::cos(0.03 * p.x()), 3.0 * std::sin(0.03 * p.x()));
  };
  Mesh target = test::bumpy_sphere(60, 0.0, 9);
  for (int v = 0; v < target.positions.rows(); ++v)
    target.positions.row(v) = skin(target.positions.row(v).transpose()).transpose();
  const Case c(test::bumpy_sphere(36, 0.0, 2), std::move(target), 26.0);
  RegistrationEnergy energy = c.energy();
  const EnergyRegistration found = minimize_energy(energy, c.bones.surface().rest);
  EXPECT_LT(found.final.distance, 0.1 * found.initial.distance);
  const Points moved = c.bones(found.control);
  Eigen::VectorXd slide(moved.rows()), before(moved.rows());
  for (int v = 0; v < moved.rows(); ++v) {
    const Eigen::Vector3d rest = c.mesh.positions.row(v), truth = skin(rest);
    slide[v] = (moved.row(v).transpose() - truth).norm();
    before[v] = (rest - truth).norm();
  }
  EXPECT_LT(slide.mean(), 0.6 * before.mean());  // a ball without landmarks tells little about the tangential part
}

TEST(EnergyRegistration, NamesAndBadOptions) {
  EXPECT_EQ(energy_solver_named("simplex"), EnergySolver::simplex);
  EXPECT_EQ(name_of(EnergySolver::ceres), "ceres");
  EXPECT_THROW(energy_solver_named("cerez"), UsageError);
  const Case c(sheet(8, 40.0, flat), sheet(8, 40.0, flat), 20.0);
  EnergyOptions sharp;
  sharp.softness = 0.0;
  RegistrationEnergy energy = c.energy(sharp);
  EXPECT_THROW(minimize_energy(energy, c.bones.surface().rest), InputError);  // Ceres cannot do without
  EnergyRegistrationOptions options;
  options.rounds = 0;
  EXPECT_THROW(minimize_energy(energy, c.bones.surface().rest, options), InputError);
}

}  // namespace
}  // namespace vultus::registration
