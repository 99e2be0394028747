#include <gtest/gtest.h>

#include <initializer_list>
#include <string>

#include "register/fill.h"

namespace vultus::registration {
namespace {

// A sheet of skin, 120 mm wide, over an eyeball of 12 mm that is a piece of its own.
Mesh skin_over_eyeball(const std::string& set) {
  constexpr int side = 61;
  TopologyData data;
  data.face_offsets.push_back(0);
  auto add_face = [&](std::initializer_list<int> corners) {
    data.corner_vertex.insert(data.corner_vertex.end(), corners);
    data.face_offsets.push_back(static_cast<int>(data.corner_vertex.size()));
  };
  Points positions(side * side + 6, 3);
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      positions.row(side * i + j) << 2.0 * (j - 30), 2.0 * (i - 30), 0.0;
      if (i + 1 < side && j + 1 < side)
        add_face({side * i + j, side * i + j + 1, side * (i + 1) + j + 1, side * (i + 1) + j});
    }
  const int e = side * side;
  for (int k = 0; k < 6; ++k) {
    positions.row(e + k) << 0, 0, -12;
    positions(e + k, k / 2) += k % 2 ? 12.0 : -12.0;
    data.sets[set].push_back(e + k);
  }
  for (int x : {0, 1})
    for (int y : {2, 3})
      for (int z : {4, 5}) add_face({e + x, e + y, e + z});
  data.vertex_count = e + 6;
  Mesh mesh;
  mesh.topology = Topology::make(std::move(data));
  mesh.positions = positions;
  return mesh;
}

TEST(CarryComponents, AnEyeballStaysWhenItsLidsMove) {
  const Mesh mesh = skin_over_eyeball("eyeball_left");
  std::vector<bool> fitted(mesh.positions.rows(), true);
  for (int v : mesh.topology->set("eyeball_left")) fitted[v] = false;
  Points moved = mesh.positions;
  for (int v = 0; v < moved.rows(); ++v)
    if (fitted[v] && moved.row(v).norm() < 11.0) moved(v, 2) += 6.0;
  carry_components(*mesh.topology, mesh.positions, fitted, false, moved);
  for (int v : mesh.topology->set("eyeball_left")) EXPECT_LT((moved.row(v) - mesh.positions.row(v)).norm(), 0.01);
}

TEST(CarryComponents, AnythingElseFollowsTheSkinAroundIt) {
  const Mesh mesh = skin_over_eyeball("teeth");
  std::vector<bool> fitted(mesh.positions.rows(), true);
  for (int v : mesh.topology->set("teeth")) fitted[v] = false;
  Points moved = mesh.positions;
  for (int v = 0; v < moved.rows(); ++v)
    if (fitted[v]) moved.row(v) += Eigen::RowVector3d(1, 2, 3);
  carry_components(*mesh.topology, mesh.positions, fitted, false, moved);
  for (int v : mesh.topology->set("teeth"))
    EXPECT_LT((moved.row(v) - mesh.positions.row(v) - Eigen::RowVector3d(1, 2, 3)).norm(), 1e-6);
}

}  // namespace
}  // namespace vultus::registration
