#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "register/lip_opening.h"

namespace vultus::registration {
namespace {

// A patch of face seen along z: heights in mm over x and y, half-millimetre grid.
Mesh patch(const std::function<double(double, double)>& height) {
  const int columns = 121, rows = 121;
  Mesh mesh;
  mesh.positions.resize(columns * rows, 3);
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const double x = 0.5 * (i - 60), y = 0.5 * (j - 60);
      mesh.positions.row(j * columns + i) << x, y, height(x, y);
    }
  Triangles triangles(2 * (columns - 1) * (rows - 1), 3);
  int t = 0;
  for (int j = 0; j + 1 < rows; ++j)
    for (int i = 0; i + 1 < columns; ++i) {
      const int a = j * columns + i;
      triangles.row(t++) << a, a + 1, a + columns + 1;
      triangles.row(t++) << a, a + columns + 1, a + columns;
    }
  mesh.topology = Topology::from_triangles(columns * rows, triangles);
  return mesh;
}

// Two round lips about `middle`, `gap` mm apart; between them the mouth's inside, 10 mm deep.
Mesh mouth(double middle, double gap) {
  return patch([=](double, double y) {
    const double from_edge = std::abs(y - middle) - 0.5 * gap;
    if (from_edge < 0.0) return -10.0;
    return from_edge < 5.0 ? 4.0 * std::sqrt(1.0 - std::pow((5.0 - from_edge) / 5.0, 2))
                           : 4.0 - 0.2 * (from_edge - 5.0);
  });
}

struct Face {
  Template head;
  Points rest;
};

// Inner lips of the neutral 1 mm apart.
Face face() {
  Face made;
  made.head.ibug68.emplace();
  for (int i = 0; i < 68; ++i) (*made.head.ibug68)[i] = i;
  made.rest = Points::Zero(68, 3);
  for (int i : {61, 62, 63}) made.rest(i, 1) = 0.5;
  for (int i : {65, 66, 67}) made.rest(i, 1) = -0.5;
  return made;
}

Anchors found(std::initializer_list<std::pair<int, Eigen::Vector3d>> points) {
  Anchors anchors;
  anchors.targets.resize(points.size(), 3);
  anchors.confidence = Eigen::VectorXd::Constant(points.size(), 0.5);
  for (const auto& [index, place] : points) {
    anchors.targets.row(anchors.size()) = place;
    anchors.names.push_back(ibug_name(index));
    anchors.vertices.push_back(index);
  }
  return anchors;
}

// What pictures say: outer points about right, inner ones near the middle whatever the mouth does.
Anchors seen() {
  return found({{27, {0, 60, 0}},
                {48, {-25, 0, 0}},
                {54, {25, 0, 0}},
                {50, {-8, 11, 3}},
                {51, {0, 11, 3}},
                {52, {8, 11, 3}},
                {56, {8, -11, 3}},
                {57, {0, -11, 3}},
                {58, {-8, -11, 3}},
                {61, {-8, 1.5, 2}},
                {62, {0, 1.5, 2}},
                {66, {0, -1.5, 2}},
                {67, {-8, -1.5, 2}}});
}

Eigen::Vector3d target(const Anchors& anchors, int index) {
  for (int i = 0; i < anchors.size(); ++i)
    if (anchors.names[i] == ibug_name(index)) return anchors.targets.row(i);
  ADD_FAILURE() << "no anchor " << index;
  return Eigen::Vector3d::Zero();
}

TEST(LipOpening, AnOpenMouthHasItsAnchorsOnTheEdgesMissingOnesToo) {
  const Face model = face();
  const Mesh scan = mouth(0.0, 9.0);
  const Anchors set = with_inner_lips(model.head, seen(), model.rest, RayScene(*scan.topology, scan.positions));
  for (int upper : {61, 62, 63})
    EXPECT_NEAR(target(set, upper).y(), 4.5, 1.0) << upper;  // a grid step and the lip's curve
  for (int lower : {65, 66, 67}) EXPECT_NEAR(target(set, lower).y(), -4.5, 1.0) << lower;
}

TEST(LipOpening, AClosedMouthKeepsTheNeutralsGap) {
  const Face model = face();
  const Mesh scan = mouth(0.0, 0.0);
  const Anchors set = with_inner_lips(model.head, seen(), model.rest, RayScene(*scan.topology, scan.positions));
  for (const auto& [upper, lower] : {std::pair(61, 67), std::pair(62, 66), std::pair(63, 65)}) {
    EXPECT_NEAR((target(set, upper) - target(set, lower)).y(), 1.0, 1e-9);
    EXPECT_NEAR(0.5 * (target(set, upper) + target(set, lower)).y(), 0.0, 0.3);
  }
}

TEST(LipOpening, PointsPlacedByHandAndSmoothSkinStay) {
  const Face model = face();
  Anchors by_hand = seen();
  by_hand.confidence.setOnes();
  const Mesh open = mouth(0.0, 9.0);
  EXPECT_EQ(target(with_inner_lips(model.head, by_hand, model.rest, RayScene(*open.topology, open.positions)), 62),
            target(by_hand, 62));
  const Mesh smooth = patch([](double x, double y) { return -0.002 * (x * x + y * y); });
  const Anchors before = seen();
  const Anchors after = with_inner_lips(model.head, before, model.rest, RayScene(*smooth.topology, smooth.positions));
  EXPECT_EQ(after.targets, before.targets);
}

}  // namespace
}  // namespace vultus::registration
