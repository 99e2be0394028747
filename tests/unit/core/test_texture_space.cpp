#include <gtest/gtest.h>

#include "core/error.h"
#include "core/texture_space.h"

namespace vultus {
namespace {

/// One quad whose chart is the UV rectangle [low, high]².
TopologyData quad_chart(double low, double high) {
  TopologyData data;
  data.vertex_count = 4;
  data.face_offsets = {0, 4};
  data.corner_vertex = {0, 1, 2, 3};
  data.corner_uv = {0, 1, 2, 3};
  data.uvs.resize(4, 2);
  data.uvs << low, low, high, low, high, high, low, high;
  return data;
}

Points unit_square() {
  Points positions(4, 3);
  positions << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
  return positions;
}

TEST(TextureSpace, EveryTexelOfAFullChartKnowsItsPlace) {
  const auto topology = Topology::make(quad_chart(0, 1));
  const TextureSpace space(topology, 8, 4);
  EXPECT_EQ(space.overlapping_texels(), 0);  // the diagonal passes through texel centres and is no overlap
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x) {
      ASSERT_TRUE(space.at(x, y).valid());
      const Eigen::Vector3d p = position_of(space.at(x, y), *topology, unit_square());
      EXPECT_NEAR((p - Eigen::Vector3d((x + 0.5) / 8, 1 - (y + 0.5) / 4, 0)).norm(), 0, 1e-12);
      EXPECT_NEAR((space.uv(space.at(x, y)) - p.head<2>()).norm(), 0, 1e-12);
    }
}

TEST(TextureSpace, TexelsOutsideEveryChartAreInvalid) {
  const TextureSpace space(Topology::make(quad_chart(0.25, 0.75)), 16, 16);
  int valid = 0;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) {
      const bool inside = x >= 4 && x < 12 && y >= 4 && y < 12;
      EXPECT_EQ(space.at(x, y).valid(), inside) << x << " " << y;
      valid += inside;
    }
  EXPECT_EQ(valid, 64);
}

TEST(TextureSpace, MirroredChartsAreSeenToo) {
  TopologyData data = quad_chart(0, 1);
  data.uvs.col(0) = 1.0 - data.uvs.col(0).array();
  const auto topology = Topology::make(std::move(data));
  const TextureSpace space(topology, 4, 4);
  EXPECT_NEAR(position_of(space.at(0, 0), *topology, unit_square()).x(), 0.875, 1e-12);
}

TEST(TextureSpace, CountsOverlaps) {
  TopologyData data = quad_chart(0, 1);
  data.face_offsets = {0, 4, 8};
  data.corner_vertex = {0, 1, 2, 3, 0, 1, 2, 3};
  data.corner_uv = {0, 1, 2, 3, 0, 1, 2, 3};
  // Off the two diagonals' texels both copies cover every centre strictly.
  EXPECT_GE(TextureSpace(Topology::make(std::move(data)), 8, 8).overlapping_texels(), 64 - 8);
}

TEST(TextureSpace, BakesAndSamplesALinearField) {
  const auto topology = Topology::make(quad_chart(0.25, 0.75));
  const TextureSpace space(topology, 64, 64);
  Eigen::MatrixXf values(4, 2);
  values << 0, 5, 1, 5, 1, 5, 0, 5;  // x, and a constant
  const Image map = space.bake(values, {"x", "five"});
  EXPECT_EQ(map.channel_names(), (std::vector<std::string>{"x", "five"}));
  for (const double along : {0.2, 0.5, 0.8}) {
    // Triangle 0 is (0, 1, 2): x is the sum of the weights of vertices 1 and 2.
    const SurfacePoint place{0, {1 - along, 0.3 * along, 0.7 * along}};
    EXPECT_NEAR(space.sample(map, place, 0), along, 1e-5);
    EXPECT_NEAR(space.sample(map, place, 1), 5, 1e-5);
  }
  // The gutter holds the chart's edge, so that look-ups there do not darken, and ends after 4 texels.
  EXPECT_FLOAT_EQ(map.at(13, 30)[1], 5);
  EXPECT_FLOAT_EQ(map.at(12, 30)[1], 5);
  EXPECT_FLOAT_EQ(map.at(11, 30)[1], 0);
}

TEST(TextureSpace, DilationGrowsByWholeRings) {
  const TextureSpace space(Topology::make(quad_chart(0.4, 0.6)), 10, 10);  // texels 4 and 5 each way
  Image image(10, 10, {"v"});
  for (int y = 4; y < 6; ++y)
    for (int x = 4; x < 6; ++x) *image.at(x, y) = 2;
  *image.at(3, 3) = 77;  // an empty texel's content is replaced
  space.dilate(image, 1);
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 10; ++x)
      EXPECT_FLOAT_EQ(*image.at(x, y), x >= 3 && x < 7 && y >= 3 && y < 7 ? 2.0f : 0.0f) << x << " " << y;
}

TEST(TextureSpace, VertexUvsComeFromACorner) {
  const auto topology = Topology::make(quad_chart(0.25, 0.75));
  EXPECT_EQ(TextureSpace(topology, 4, 4).vertex_uvs(), topology->uvs());
}

TEST(TextureSpace, RefusesWhatItCannotDo) {
  Triangles triangle(1, 3);
  triangle << 0, 1, 2;
  EXPECT_THROW(TextureSpace(Topology::from_triangles(3, triangle), 8, 8), InputError);
  const auto topology = Topology::make(quad_chart(0, 1));
  EXPECT_THROW(TextureSpace(topology, 0, 8), InputError);
  const TextureSpace space(topology, 8, 8);
  EXPECT_THROW(space.bake(Eigen::MatrixXf::Zero(3, 1), {"v"}), InputError);
  EXPECT_THROW(space.bake(Eigen::MatrixXf::Zero(4, 1), {"a", "b"}), InputError);
  Image other(4, 4, {"v"});
  EXPECT_THROW(space.dilate(other, 1), InputError);
}

}  // namespace
}  // namespace vultus
