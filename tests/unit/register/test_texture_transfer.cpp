#include <gtest/gtest.h>

#include "core/error.h"
#include "core/texture_space.h"
#include "register/texture_transfer.h"

namespace vultus::registration {
namespace {

/// n×n quads over [0, 10]² mm in the plane z, with UVs over the unit square.
Mesh plane(int n, double z) {
  TopologyData data;
  data.vertex_count = (n + 1) * (n + 1);
  data.uvs.resize(data.vertex_count, 2);
  Points positions(data.vertex_count, 3);
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const int v = j * (n + 1) + i;
      data.uvs.row(v) << i / double(n), j / double(n);
      positions.row(v) << 10.0 * i / n, 10.0 * j / n, z;
    }
  data.face_offsets = {0};
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int v = j * (n + 1) + i;
      for (const int c : {v, v + 1, v + n + 2, v + n + 1}) data.corner_vertex.push_back(c);
      data.face_offsets.push_back(static_cast<int>(data.corner_vertex.size()));
    }
  data.corner_uv = data.corner_vertex;
  return {Topology::make(std::move(data)), positions, {}, {}};
}

Mesh painted(Mesh mesh) {  // red grows along x, green along y
  mesh.colours = mesh.positions / 10.0;
  mesh.colours.col(2).setConstant(0.25);
  return mesh;
}

ColourTransferOptions small() {
  ColourTransferOptions options;
  options.size = 32;
  return options;
}

TEST(TextureTransfer, carries_a_linear_colour_exactly) {
  const Mesh target = plane(4, 0.0);
  const Image map = transfer_colours(target, painted(plane(7, 0.4)), Points::Zero(25, 3), small());
  for (const int x : {0, 9, 31})
    for (const int y : {0, 20, 31}) {
      const Eigen::Vector3f colour = map.rgb_at(x, y);
      EXPECT_NEAR(colour.x(), (x + 0.5) / 32.0, 1e-5);  // float32 map
      EXPECT_NEAR(colour.y(), 1.0 - (y + 0.5) / 32.0, 1e-5);
      EXPECT_NEAR(colour.z(), 0.25, 1e-6);
    }
}

TEST(TextureTransfer, takes_nothing_from_the_far_or_turned_away_side) {
  const Mesh target = plane(4, 0.0);
  const Points grey = Points::Constant(25, 3, 0.5);
  const Image far = transfer_colours(target, painted(plane(7, 5.0)), grey, small());
  EXPECT_NEAR(far.rgb_at(3, 28).x(), 0.5f, 1e-6);
  Mesh back = painted(plane(7, 0.2));
  back.positions.col(0) = 10.0 - back.positions.col(0).array();  // mirrored: its faces look along -z
  const Image turned = transfer_colours(target, back, grey, small());
  EXPECT_NEAR(turned.rgb_at(3, 28).x(), 0.5f, 1e-6);
}

TEST(TextureTransfer, fills_a_hole_from_its_rim_and_leaves_hidden_parts) {
  Mesh target = plane(8, 0.0);
  Mesh scan = painted(plane(8, 0.1));
  scan.colours.setConstant(0.8);
  std::vector<bool> keep(81, true);
  for (const int v : {39, 40, 41, 49, 50, 48}) keep[v] = false;
  const Mesh holed = sub_mesh(scan, keep).mesh;
  ColourTransferOptions options = small();
  options.farthest = 0.5;
  const Image filled = transfer_colours(target, holed, Points::Zero(81, 3), options);
  EXPECT_NEAR(filled.rgb_at(16, 16).x(), 0.8f, 1e-4);  // the rim is of one colour, so the fill is too
  TopologyData data = target.topology->data();
  data.sets["eyeball_left"] = {40};
  target.topology = Topology::make(std::move(data));
  const Image eye = transfer_colours(target, holed, Points::Zero(81, 3), options);
  EXPECT_LT(eye.rgb_at(16, 16).x(), 0.2f);  // texel beside vertex 40, which keeps its black
}

TEST(TextureTransfer, refuses_scans_without_colour) {
  EXPECT_FALSE(has_colour(plane(2, 0.0)));
  EXPECT_THROW(transfer_colours(plane(2, 0.0), plane(2, 0.0), Points::Zero(9, 3)), InputError);
}

}  // namespace
}  // namespace vultus::registration
