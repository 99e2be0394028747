#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>

#include "core/error.h"
#include "scan/thin.h"

namespace vultus::scan {
namespace {

// A flat square of `side` by `side` quads a millimetre wide, looking along +z, colour = x / side.
Mesh sheet(int side) {
  TopologyData data;
  data.vertex_count = (side + 1) * (side + 1);
  Mesh mesh;
  mesh.positions.resize(data.vertex_count, 3);
  mesh.colours.resize(data.vertex_count, 3);
  data.face_offsets.push_back(0);
  for (int y = 0; y <= side; ++y)
    for (int x = 0; x <= side; ++x) {
      const int v = y * (side + 1) + x;
      mesh.positions.row(v) << x, y, 0.0;
      mesh.colours.row(v).setConstant(static_cast<double>(x) / side);
      if (x == side || y == side) continue;
      for (const auto& corners : {std::array{v, v + 1, v + side + 2}, std::array{v, v + side + 2, v + side + 1}}) {
        data.corner_vertex.insert(data.corner_vertex.end(), corners.begin(), corners.end());
        data.face_offsets.push_back(static_cast<int>(data.corner_vertex.size()));
      }
    }
  mesh.topology = Topology::make(std::move(data));
  return mesh;
}

// Cells of four by four vertices: their means are 1.5 mm from the first, and the coarse sheet keeps side and colour.
TEST(Thinned, CellsBecomeTheirMeans) {
  const Mesh thin = thinned(sheet(39), 4.0);
  ASSERT_EQ(thin.positions.rows(), 100);
  EXPECT_NEAR(thin.positions.col(0).minCoeff(), 1.5, 1e-12);
  EXPECT_NEAR(thin.positions.col(0).maxCoeff(), 37.5, 1e-12);
  EXPECT_LT((thin.colours.col(0) - thin.positions.col(0) / 39.0).cwiseAbs().maxCoeff(), 1e-12);
  const Triangles& triangles = thin.topology->triangles();
  ASSERT_EQ(triangles.rows(), 2 * 9 * 9);
  double area = 0.0;
  for (int t = 0; t < triangles.rows(); ++t) {
    const Eigen::Vector3d a = thin.positions.row(triangles(t, 0)), b = thin.positions.row(triangles(t, 1)),
                          c = thin.positions.row(triangles(t, 2));
    const double signed_area = 0.5 * (b - a).cross(c - a).z();
    EXPECT_GT(signed_area, 0.0);
    area += signed_area;
  }
  EXPECT_NEAR(area, 36.0 * 36.0, 1e-9);
}

TEST(Thinned, NothingIsLeftOfWhatFitsOneCellButAPoint) {
  const Mesh thin = thinned(sheet(3), 100.0);
  EXPECT_EQ(thin.positions.rows(), 1);
  EXPECT_EQ(thin.topology->triangles().rows(), 0);
}

TEST(Thinned, ACellHasASize) { EXPECT_THROW(thinned(sheet(3), 0.0), InputError); }

}  // namespace
}  // namespace vultus::scan
