#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <vector>

#include "register/jaw.h"

namespace vultus::registration {
namespace {

constexpr int half_width = 60;  // mm to either side; grids of 1 mm

// Two round lips at y = 0, the upper one below a nose and the lower one above a chin, on a curved face.
double height(double x, double y) {
  const double from_rim = std::abs(y);
  const double lip = 4.0 * std::exp(-std::pow((from_rim - 5.0) / 4.0, 2));
  const double chin = y < 0.0 ? 6.0 * std::exp(-std::pow((y + 36.0) / 10.0, 2)) : 0.0;
  return lip + chin - x * x / 90.0 - y * y / 400.0;
}

// Rows of the grid between `top` and `bottom` mm, as one piece; both count down from the brow.
struct Piece {
  double top;
  int rows;
  int row_of(double y) const { return static_cast<int>(std::lround(top - y)); }
};
constexpr Piece upper{70.5, 71}, lower{-0.5, 60};
constexpr int columns = 2 * half_width + 1;

int vertex(double x, double y) {
  const int column = static_cast<int>(x) + half_width;
  return y > 0.0 ? upper.row_of(y) * columns + column : (upper.rows + lower.row_of(y)) * columns + column;
}

// Both pieces; cells for which `there` says no (by their centre) are left out.
Mesh face(const std::function<bool(double, double)>& there) {
  Mesh mesh;
  mesh.positions.resize((upper.rows + lower.rows) * columns, 3);
  std::vector<Eigen::RowVector3i> triangles;
  for (const Piece& piece : {upper, lower})
    for (int i = 0; i < piece.rows; ++i)
      for (int x = -half_width; x <= half_width; ++x) {
        const double y = piece.top - i;
        mesh.positions.row(vertex(x, y)) << x, y, height(x, y);
        if (i == 0 || x == half_width || !there(x + 0.5, y + 0.5)) continue;
        const int a = vertex(x, y), b = vertex(x + 1, y), c = vertex(x, y + 1.0), d = vertex(x + 1, y + 1.0);
        triangles.emplace_back(a, b, d);
        triangles.emplace_back(a, d, c);
      }
  Triangles all(triangles.size(), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t) all.row(t) = triangles[t];
  mesh.topology = Topology::from_triangles(static_cast<int>(mesh.positions.rows()), all);
  return mesh;
}

Mesh whole_face() {
  return face([](double, double) { return true; });
}

Template named(const Mesh& mesh) {
  Template head;
  head.topology = mesh.topology;
  Ibug68& ibug = head.ibug68.emplace();
  ibug.fill(-1);
  ibug[0] = vertex(-60, 30.5), ibug[1] = vertex(-60, 20.5), ibug[15] = vertex(60, 20.5), ibug[16] = vertex(60, 30.5);
  ibug[8] = vertex(0, -40.5), ibug[27] = vertex(0, 60.5);
  ibug[48] = vertex(-25, 0.5), ibug[54] = vertex(25, 0.5), ibug[57] = vertex(0, -8.5);
  for (int i = 0; i < 3; ++i) {
    ibug[61 + i] = vertex(8 * (i - 1), 0.5);
    ibug[67 - i] = vertex(8 * (i - 1), -0.5);
  }
  return head;
}

// The jaw of `mesh` turned by 8 degrees about the ears' axis, 28 mm down, 10 mm back.
Similarity opening() {
  Similarity motion;
  motion.rotation = Eigen::AngleAxisd(8.0 * M_PI / 180.0, Eigen::Vector3d::UnitX()).toRotationMatrix();
  motion.translation = Eigen::Vector3d(0, -28, -10);
  return motion;
}

Mesh opened(Mesh mesh) {
  for (int v = upper.rows * columns; v < mesh.positions.rows(); ++v)
    mesh.positions.row(v) = opening() * Eigen::Vector3d(mesh.positions.row(v));
  return mesh;
}

Anchors none() { return {{}, {}, Points(0, 3), Eigen::VectorXd(0)}; }

TEST(MouthGape, RimsLieWhereDataEnds) {
  const Mesh rest = whole_face();
  const Template head = named(rest);
  const Mesh scan = opened(rest);
  const auto gape = find_gape(head, rest.positions, RayScene(*scan.topology, scan.positions));
  ASSERT_TRUE(gape);
  for (int i = 0; i < 3; ++i) {
    // A ray every 0.25 mm, and columns up to 2 mm aside on a curved rim.
    EXPECT_LT((gape->upper[i] - scan.positions.row((*head.ibug68)[61 + i]).transpose()).norm(), 0.6);
    EXPECT_LT((gape->lower[i] - scan.positions.row((*head.ibug68)[67 - i]).transpose()).norm(), 0.6);
  }
}

TEST(MouthGape, ClosedLipsHaveNone) {
  const Mesh rest = whole_face();
  EXPECT_FALSE(find_gape(named(rest), rest.positions, RayScene(*rest.topology, rest.positions)));
}

TEST(GapingJaw, MotionIsFoundWithoutLandmarks) {
  const Mesh rest = whole_face();
  const Template head = named(rest);
  const Mesh scan = opened(rest);
  const std::vector<bool> fitted(rest.positions.rows(), true);
  const ScanSurface surface(scan);
  const JawOpening jaw = find_jaw_opening(head, *rest.topology, rest.positions, fitted, none(), surface);
  ASSERT_TRUE(jaw.gape);
  const Eigen::Vector3d chin = rest.positions.row((*head.ibug68)[8]);
  // The rims are half a millimetre off, and the turn is held back a little.
  EXPECT_LT((jaw.motion * chin - opening() * chin).norm(), 1.0);
  EXPECT_NEAR(jaw.drop, (opening() * chin - chin).norm(), 1.0);
  EXPECT_NEAR(jaw.angle * 180.0 / M_PI, 8.0, 1.5);
  EXPECT_FALSE(jaw.terms.empty());
}

TEST(GapingJaw, HoleInTheDataOverClosedLipsIsNoOpening) {
  const Mesh rest = whole_face();
  const Template head = named(rest);
  const Mesh scan = face([](double x, double y) { return std::abs(x) > 18.0 || y > 2.0 || y < -11.0; });
  ASSERT_TRUE(find_gape(head, rest.positions, RayScene(*scan.topology, scan.positions)));
  const std::vector<bool> fitted(rest.positions.rows(), true);
  const ScanSurface surface(scan);
  const JawOpening jaw = find_jaw_opening(head, *rest.topology, rest.positions, fitted, none(), surface);
  EXPECT_EQ(jaw.drop, 0.0);
  EXPECT_FALSE(jaw.gape);
}

TEST(GapingJaw, FoundPointsThatDisagreeAreLeftOut) {
  const Mesh rest = whole_face();
  const Template head = named(rest);
  JawOpening jaw;
  jaw.motion = opening();
  jaw.gape.emplace();
  for (int i = 0; i < 3; ++i) {
    jaw.gape->upper[i] = rest.positions.row((*head.ibug68)[61 + i]);
    jaw.gape->lower[i] = jaw.motion * Eigen::Vector3d(rest.positions.row((*head.ibug68)[67 - i]));
  }
  Anchors anchors = none();
  const auto add = [&](int ibug, const Eigen::Vector3d& target, double confidence) {
    anchors.add(ibug_name(ibug), (*head.ibug68)[ibug], target, confidence);
  };
  const Eigen::Vector3d lip = rest.positions.row((*head.ibug68)[57]), corner = rest.positions.row((*head.ibug68)[48]);
  add(57, lip, 0.6);                                   // left where it was by a finder that saw a closed mouth
  add(48, corner + Eigen::Vector3d(0, -15, -5), 0.6);  // half the jaw's way
  add(54, Eigen::Vector3d(25, -60, 0), 1.0);           // by hand: whatever it says
  const Anchors kept = agreeing_anchors(head, anchors, rest.positions, jaw);
  EXPECT_EQ(kept.names, (std::vector<std::string>{"ibug.48", "ibug.54", "ibug.61", "ibug.62", "ibug.63", "ibug.67",
                                                  "ibug.66", "ibug.65"}));
  EXPECT_LT((kept.targets.row(6).transpose() - jaw.gape->lower[1]).norm(), 1e-12);
  jaw.gape.reset();
  EXPECT_EQ(agreeing_anchors(head, anchors, rest.positions, jaw).names, anchors.names);
}

TEST(GapingJaw, LowerLipIsJudgedByItsOwnRim) {
  const Mesh rest = whole_face();
  const Template head = named(rest);
  const Eigen::Vector3d roll(0, 6, 3);  // drawn up against the teeth while the jaw falls
  JawOpening jaw;
  jaw.motion = opening();
  jaw.gape.emplace();
  for (int i = 0; i < 3; ++i) {
    jaw.gape->upper[i] = rest.positions.row((*head.ibug68)[61 + i]);
    jaw.gape->lower[i] = jaw.motion * Eigen::Vector3d(rest.positions.row((*head.ibug68)[67 - i])) + roll;
  }
  Anchors anchors = none();
  const auto add = [&](int ibug, const Eigen::Vector3d& off) {
    const int vertex = (*head.ibug68)[ibug];
    anchors.add(ibug_name(ibug), vertex, jaw.motion * Eigen::Vector3d(rest.positions.row(vertex)) + off, 0.6);
  };
  add(56, roll + Eigen::Vector3d(2, 1, 0));
  add(57, Eigen::Vector3d(0, -2, -2));  // where a lip that goes along with the jaw would be, and below
  const Anchors kept = agreeing_anchors(head, anchors, rest.positions, jaw);
  EXPECT_EQ(kept.names.front(), "ibug.56");
  EXPECT_EQ(std::count(kept.names.begin(), kept.names.end(), "ibug.57"), 0);
}

}  // namespace
}  // namespace vultus::registration
