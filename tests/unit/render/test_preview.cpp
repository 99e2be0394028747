#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "render/colour_map.h"
#include "render/face_look.h"
#include "render/portrait.h"
#include "render/preview.h"

namespace vultus::render {
namespace {

using Eigen::Vector3f;

/// A flat square of 100 mm in z = 0, facing +z, of `n`×`n` quads.
Mesh plane(int n) {
  Mesh mesh;
  mesh.positions.resize((n + 1) * (n + 1), 3);
  TopologyData data;
  data.vertex_count = (n + 1) * (n + 1);
  data.face_offsets.push_back(0);
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x) {
      const int v = y * (n + 1) + x;
      mesh.positions.row(v) << 100.0 * x / n - 50, 100.0 * y / n - 50, 0;
      if (x == n || y == n) continue;
      for (const int corner : {v, v + 1, v + n + 2, v + n + 1}) data.corner_vertex.push_back(corner);
      data.face_offsets.push_back(static_cast<int>(data.corner_vertex.size()));
    }
  mesh.topology = Topology::make(std::move(data));
  return mesh;
}

Camera front(int size) { return Camera::look_at({0, 0, 500}, {0, 0, 0}, {0, 1, 0}, 0.25, size, size); }

/// CIE lightness of a linear colour.
double lightness(const Vector3f& c) {
  const double y = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
  return y > 0.008856 ? 116 * std::cbrt(y) - 16 : 903.3 * y;
}

TEST(ColourMap, SequentialDarkensEvenly) {
  double last = lightness(mapped_colour(ColourMap::sequential, 0));
  EXPECT_GT(last, 90);
  for (int i = 1; i <= 20; ++i) {
    const double now = lightness(mapped_colour(ColourMap::sequential, i / 20.0));
    EXPECT_LT(now, last - 2.0) << i;  // an even fall of 77 would be 3.9 a step
    EXPECT_GT(now, last - 6.5) << i;
    last = now;
  }
}

TEST(ColourMap, DivergingIsPaleInTheMiddleAndBlueOrRedAtTheEnds) {
  const Vector3f low = mapped_colour(ColourMap::diverging, 0), high = mapped_colour(ColourMap::diverging, 1);
  EXPECT_GT(low[2], 2 * low[0]);
  EXPECT_GT(high[0], 2 * high[2]);
  EXPECT_GT(lightness(mapped_colour(ColourMap::diverging, 0.5)), 90);
  EXPECT_NEAR(lightness(low), lightness(high), 6);
}

TEST(ColourMap, ClampsAndShowsMissingValuesGrey) {
  EXPECT_EQ(mapped_colour(ColourMap::sequential, -3), mapped_colour(ColourMap::sequential, 0));
  EXPECT_EQ(mapped_colour(ColourMap::sequential, 7), mapped_colour(ColourMap::sequential, 1));
  const Vector3f none = mapped_colour(ColourMap::sequential, std::nan(""));
  EXPECT_EQ(none[0], none[1]);
  EXPECT_EQ(none[1], none[2]);
}

TEST(ColourMap, DistinctColoursDiffer) {
  const auto colours = distinct_colours(12);
  ASSERT_EQ(colours.size(), 12u);
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < i; ++j) EXPECT_GT((colours[i] - colours[j]).norm(), 0.08f) << i << " " << j;
}

TEST(ColourMap, BarRunsFromLowToHigh) {
  const Image bar = colour_bar(ColourMap::sequential, 100, 5);
  EXPECT_EQ(bar.rgb_at(0, 3), mapped_colour(ColourMap::sequential, 0.005));
  EXPECT_EQ(bar.rgb_at(99, 0), mapped_colour(ColourMap::sequential, 0.995));
}

TEST(Preview, FieldIsShownInItsColours) {
  const Mesh mesh = plane(10);
  VertexField field;
  field.low = -50;
  field.high = 50;
  for (Eigen::Index v = 0; v < mesh.positions.rows(); ++v)
    field.values.push_back(static_cast<float>(mesh.positions(v, 0)));
  PreviewOptions options;
  options.field = field;
  options.contrast = 0.0;  // flat: the legend's own colours
  const Camera camera = front(64);
  const Image image = render_preview(mesh, camera, options);
  for (const double x : {-35.0, 5.0, 35.0}) {  // vertices are 10 mm apart; colours are mapped there
    const Eigen::Vector3d pixel = camera.project({x, 5, 0});
    const Vector3f expected = mapped_colour(ColourMap::sequential, (x + 50) / 100);
    const Vector3f shown = image.rgb_at(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
    EXPECT_LT((shown - expected).norm(), 0.06f) << x;
  }
}

TEST(Preview, AlphaIsCoverageAndBackgroundReplacesIt) {
  const Mesh mesh = plane(2);
  const Image clear = render_preview(mesh, front(64));
  ASSERT_EQ(clear.channels(), 4);
  EXPECT_EQ(clear.at(0, 0)[3], 0.0f);
  EXPECT_EQ(clear.at(32, 32)[3], 1.0f);
  PreviewOptions options;
  options.background = Vector3f(0.1f, 0.2f, 0.3f);
  const Image opaque = render_preview(mesh, front(64), options);
  ASSERT_EQ(opaque.channels(), 3);
  EXPECT_EQ(opaque.rgb_at(0, 0), *options.background);
}

TEST(Preview, FoldsAreDark) {
  Mesh fold = plane(8);
  std::vector<bool> left(fold.positions.rows());
  for (Eigen::Index v = 0; v < fold.positions.rows(); ++v) {  // a V along y, 20 degrees wide, open to the camera
    const double x = fold.positions(v, 0);
    fold.positions.row(v) << 0.17 * x, fold.positions(v, 1), std::abs(x);
    left[v] = x <= 0;
  }
  // The wall that the light from the upper left misses, 30 mm down, with and without the other wall before it.
  const auto seen = [](const Mesh& mesh) { return render_preview(mesh, front(256)).rgb_at(120, 128)[0]; };
  const float open = seen(sub_mesh(fold, left).mesh);
  EXPECT_GT(open, 0.1f);
  EXPECT_LT(seen(fold), 0.75f * open);
}

TEST(Preview, HiddenVerticesAreLeftOut) {
  const Mesh mesh = plane(2);
  PreviewOptions options;
  for (int v = 0; v < 9; ++v) options.hidden_vertices.push_back(v);
  EXPECT_EQ(render_preview(mesh, front(16), options).at(8, 8)[3], 0.0f);
  options.hidden_vertices.pop_back();  // three triangles have vertex 8 … and stay
  EXPECT_GT(render_preview(mesh, front(16), options).at(11, 4)[3], 0.0f);
}

TEST(Preview, RefusesFieldsThatDoNotFit) {
  const Mesh mesh = plane(2);
  PreviewOptions options;
  options.field = VertexField{{1, 2, 3}, 0, 1, ColourMap::sequential};
  EXPECT_THROW(render_preview(mesh, front(8), options), InputError);
  options.field = VertexField{std::vector<float>(9), 1, 1, ColourMap::sequential};
  EXPECT_THROW(render_preview(mesh, front(8), options), InputError);
  options.field.reset();
  options.samples = 0;
  EXPECT_THROW(render_preview(mesh, front(8), options), UsageError);
}

std::shared_ptr<const Topology> named(const Mesh& mesh, VertexSets sets) {
  TopologyData data = mesh.topology->data();
  data.sets = std::move(sets);
  return Topology::make(std::move(data));
}

TEST(Portrait, FramesTheFaceSetFromTheFront) {
  Mesh mesh = plane(10);
  std::vector<int> face;
  for (int v = 0; v < mesh.positions.rows(); ++v)
    if (std::abs(mesh.positions(v, 0) - 20) <= 10.1 && std::abs(mesh.positions(v, 1) - 10) <= 20.1) face.push_back(v);
  mesh.topology = named(mesh, {{"face", face}});
  PortraitOptions options;
  options.width = 200;
  options.height = 100;
  options.margin = 2.0;
  const Camera camera = portrait_camera(*mesh.topology, mesh.positions, options);
  EXPECT_NEAR((camera.project({20, 10, 0}).head<2>() - Eigen::Vector2d(100, 50)).norm(), 0, 1e-9);
  // 40 mm of face fill half of the 100 rows, +y up, +x to the right.
  EXPECT_NEAR((camera.project({20, 30, 0}).head<2>() - Eigen::Vector2d(100, 25)).norm(), 0, 1e-6);
  EXPECT_GT(camera.project({30, 10, 0}).x(), 100);
  EXPECT_GT(camera.centre().z(), 0);
  options.azimuth = 0.5;
  EXPECT_GT(portrait_camera(*mesh.topology, mesh.positions, options).centre().x(), 20);
  options.elevation = 0.3;
  EXPECT_GT(portrait_camera(*mesh.topology, mesh.positions, options).centre().y(), 10);
}

TEST(Portrait, RefusesBadOptions) {
  const Mesh mesh = plane(2);
  PortraitOptions options;
  options.width = 0;
  EXPECT_THROW(portrait_camera(*mesh.topology, mesh.positions, options), UsageError);
  options = {};
  options.margin = std::nan("");
  EXPECT_THROW(portrait_camera(*mesh.topology, mesh.positions, options), UsageError);
  options = {};
  options.elevation = 2;
  EXPECT_THROW(portrait_camera(*mesh.topology, mesh.positions, options), UsageError);
}

TEST(FaceLook, FollowsTheNamesOfSets) {
  Mesh mesh = plane(10);
  mesh.topology =
      named(mesh, {{"lips", {60}}, {"eyeball_left", {0, 1, 11, 12}}, {"teeth", {120}}, {"eyelashes", {110}}});
  const FaceLook look = face_look(*mesh.topology, mesh.positions);
  const Eigen::RowVector3d skin = look.colours.row(5);
  EXPECT_LT(look.colours(60, 1), skin[1]);  // lips are redder
  EXPECT_LT(look.colours(61, 1), skin[1]);  // through a soft edge
  EXPECT_GT(look.colours(61, 1), look.colours(60, 1));
  EXPECT_LT(look.finishes[60].roughness, look.finishes[5].roughness);
  EXPECT_LT(look.finishes[0].roughness, 0.2f);  // eyes are wet
  EXPECT_GT(look.colours(120, 2), skin[2]);     // teeth are paler
  EXPECT_EQ(look.hidden_vertices, (std::vector<int>{110}));
}

TEST(FaceLook, EyesHaveAPupilInFront) {
  // A ball of 12 mm about (30, 5, -2) among skin.
  Points positions(3, 3);
  positions << 30, 5, 10, 42, 5, -2, 30, 17, -2;  // front, side, top
  Points all(5, 3);
  all << positions, 18, 5, -2, 30, -7, -2;
  Triangles triangles(1, 3);
  triangles << 0, 1, 2;
  TopologyData data = Topology::from_triangles(5, triangles)->data();
  data.sets = {{"eyeball_right", {0, 1, 2, 3, 4}}};
  const FaceLook look = face_look(*Topology::make(std::move(data)), all);
  EXPECT_LT(look.colours.row(0).maxCoeff(), 0.02);
  EXPECT_GT(look.colours.row(1).minCoeff(), 0.5);
}

}  // namespace
}  // namespace vultus::render
