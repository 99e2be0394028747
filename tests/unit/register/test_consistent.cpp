#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "core/rays.h"
#include "register/consistent.h"
#include "register/subdivide.h"
#include "register/template_head.h"

namespace vultus::registration {
namespace {

// Somebody else's head: smooth, some millimetres from the template everywhere.
Eigen::Vector3d other_person(const Eigen::Vector3d& p) {
  return {1.06 * p.x() + 1.5 * std::sin(p.y() / 30.0), 0.97 * p.y() + 2.0 * std::sin(p.z() / 40.0),
          1.03 * p.z() + 2.0 * std::cos(p.x() / 35.0) + 1.5 * std::sin(p.y() / 25.0)};
}

// A scan of a shape on the refined template: seen along a cylinder, own jittered grid, 0.1 mm of noise.
Mesh scan_of(const Topology& topology, const Points& shape, std::uint64_t seed) {
  const RayScene rays(topology, shape);
  Random random(seed);
  const int rows = 170, columns = 250;
  std::vector<int> number(rows * columns, -1);
  std::vector<Eigen::RowVector3d> points;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const double y = -120.0 + 230.0 * (i + random.uniform(-0.3, 0.3)) / rows;
      const double phi = -2.0 + 4.0 * (j + random.uniform(-0.3, 0.3)) / columns;
      const Eigen::Vector3d out(std::sin(phi), 0, std::cos(phi)), axis(0, y, -70.0);
      const double noise = 0.1 * random.normal();
      const auto hit = rays.hit(axis + 250.0 * out, -out, 0.0, 245.0);
      if (!hit) continue;
      number[i * columns + j] = static_cast<int>(points.size());
      points.push_back((axis + (250.0 - hit->distance + noise) * out).transpose());
    }
  std::vector<Eigen::RowVector3i> triangles;
  auto add = [&](int a, int b, int c) {
    if (a < 0 || b < 0 || c < 0) return;
    for (const auto& [p, q] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
      if ((points[p] - points[q]).norm() > 6.0) return;
    triangles.push_back({a, b, c});
  };
  for (int i = 0; i + 1 < rows; ++i)
    for (int j = 0; j + 1 < columns; ++j) {
      const int a = number[i * columns + j], b = number[i * columns + j + 1];
      const int c = number[(i + 1) * columns + j], d = number[(i + 1) * columns + j + 1];
      add(a, b, d);
      add(a, d, c);
    }
  Mesh scan;
  Triangles rows_of(triangles.size(), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t) rows_of.row(t) = triangles[t];
  scan.topology = Topology::from_triangles(static_cast<int>(points.size()), rows_of);
  scan.positions.resize(points.size(), 3);
  for (std::size_t v = 0; v < points.size(); ++v) scan.positions.row(v) = points[v];
  return scan;
}

Similarity head_pose() {
  Similarity pose;
  pose.rotation = (Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitX()))
                      .toRotationMatrix();
  pose.translation = {30, -20, 15};
  return pose;
}

struct Errors {
  double to_surface_mean = 0.0, to_place_median = 0.0;
};

// Somebody on a template that is subdivided once (for speed), scanned and turned away.
struct Sitter {
  Template head = coarse_head();
  LoopSubdivision loop{head.topology, head.subdivisions};
  Points person = loop(head.neutral);  // refined, face frame
  Mesh scan;
  ScanLandmarks landmarks;

  Sitter() {
    const LoopSubdivision fine(head.topology, 2);  // the skin that is scanned is smooth
    Points skin = fine(head.neutral);
    for (auto place : person.rowwise()) place = other_person(place.transpose()).transpose();
    for (auto place : skin.rowwise()) place = other_person(place.transpose()).transpose();
    scan = scan_of(*fine.refined(), skin, 11);
    scan.positions = transformed(head_pose(), scan.positions);
    Random random(4);
    for (const Landmark& landmark : head.landmarks) {
      if (!landmark.major) continue;  // as a person would place them, with 0.5 mm of unsteadiness
      const Eigen::Vector3d shake(random.normal(), random.normal(), random.normal());
      landmarks.push_back(
          {landmark.name, head_pose() * Eigen::Vector3d(person.row(landmark.vertex)) + 0.5 * shake, 1.0});
    }
  }
  static Template coarse_head() {
    Template made = template_head();
    made.subdivisions = 1;
    return made;
  }
};

const Sitter& sitter() {
  static const Sitter one;
  return one;
}

class RegisterNeutral : public testing::Test {
 protected:
  const Template& head = sitter().head;
  const LoopSubdivision& loop = sitter().loop;
  const Points& person = sitter().person;
  const Mesh& scan = sitter().scan;
  ScanLandmarks landmarks = sitter().landmarks;

  Registered by_zhu() const {
    RegisterOptions options;
    options.method = Method::zhu;
    return register_neutral(head, scan, landmarks, options, Progress::none());
  }
  // Found once for the tests that only look at it.
  const Registered& zhus() const {
    static const Registered found = by_zhu();
    return found;
  }

  Errors errors_of(const Registered& result) const {
    const Points back = transformed(result.face_from_scan.inverse(), result.mesh.positions);
    const Points truth = transformed(head_pose(), person);
    const RayScene clean(*loop.refined(), truth);
    Errors errors;
    std::vector<double> place;
    const auto& face = loop.refined()->set("face");
    for (int v : face) {
      errors.to_surface_mean += clean.closest(back.row(v))->distance / static_cast<double>(face.size());
      place.push_back((back.row(v) - truth.row(v)).norm());
    }
    std::nth_element(place.begin(), place.begin() + place.size() / 2, place.end());
    errors.to_place_median = place[place.size() / 2];
    return errors;
  }
};

TEST_F(RegisterNeutral, DefaultLiesOnTheSurfaceWithItsVerticesInPlace) {
  const Registered result = register_neutral(head, scan, landmarks, {}, Progress::none());
  const Errors errors = errors_of(result);
  EXPECT_LT(errors.to_surface_mean, 0.3);  // what issue 2 asks for
  EXPECT_LT(errors.to_place_median, 1.5);  // landmarks unsteady by 0.9 mm, the warp up to 8 mm
  EXPECT_NE(result.quality.verdict, Verdict::fail);
  EXPECT_EQ(result.mesh.topology->vertex_count(), loop.refined()->vertex_count());
  // The face frame: the eye line along x and the outer corners' middle where the template has it.
  const Ibug68& ibug = *head.ibug68;
  const Eigen::RowVector3d eyes = result.mesh.positions.row(ibug[45]) - result.mesh.positions.row(ibug[36]);
  EXPECT_NEAR(eyes.normalized().x(), 1.0, 0.01);
}

TEST_F(RegisterNeutral, ZhusChainFollows) {
  const Errors zhu = errors_of(zhus());
  EXPECT_LT(zhu.to_surface_mean, 1.0);
  EXPECT_LT(zhu.to_place_median, 3.0);
}

TEST_F(RegisterNeutral, IsTheSameTwice) { EXPECT_EQ(zhus().mesh.positions, by_zhu().mesh.positions); }

TEST_F(RegisterNeutral, WrongLandmarksDoNotPass) {
  // Each point under another one's name.
  std::vector<std::string> names;
  for (const ScanLandmark& landmark : landmarks) names.push_back(landmark.name);
  for (std::size_t i = 0; i < landmarks.size(); ++i) landmarks[i].name = names[(i + 5) % names.size()];
  try {
    EXPECT_NE(by_zhu().quality.verdict, Verdict::pass);
  } catch (const InputError&) {  // refusing is as good
  }
}

}  // namespace
}  // namespace vultus::registration
