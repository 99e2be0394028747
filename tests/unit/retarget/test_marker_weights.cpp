#include "retarget/marker_weights.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "small_face.h"

namespace vultus::retarget {
namespace {

using testing::SmallFace;

TEST(MarkerWeights, RowsSumToOneAndStayPositive) {
  const rig::Actor actor = SmallFace::actor(3, 2, 10.0);
  const auto places = SmallFace::places(7);
  const auto weights = marker_weights(actor, SmallFace::labels(places.size()), places);
  ASSERT_EQ(weights.values.rows(), 49);
  ASSERT_EQ(weights.values.cols(), 6);
  EXPECT_GE(weights.values.minCoeff(), 0.0);
  EXPECT_LE((weights.values.rowwise().sum().array() - 1.0).abs().maxCoeff(), 1e-12);
  EXPECT_TRUE(weights.notes.empty());
}

TEST(MarkerWeights, TwoMarkersCutTheSquareInHalf) {
  // Vertex columns 0 … 32; the markers at 8 and 24 part the patch at 16. The mask falls from 0 to 1 between columns 24
  // and 25, so the left cell is all "low" and the right one is "high" over (32 − 24.5) of its 16 columns.
  rig::Actor actor = SmallFace::actor(1, 1, 0.0);
  const Points& points = actor.neutral();
  rig::Region low{"low", Eigen::VectorXf::Zero(points.rows())}, high = low;
  high.name = "high";
  for (Eigen::Index v = 0; v < points.rows(); ++v) (points(v, 0) <= 40.0 ? low : high).vertex_mask[v] = 1.0f;
  actor.regions = {low, high};
  const int mid = SmallFace::kSide / 2, quads = SmallFace::kSide - 1;
  const auto place = [&](int column) {
    return SurfacePoint{2 * (mid * quads + column), Eigen::Vector3d(1, 0, 0)};
  };
  const auto weights = marker_weights(actor, {"left", "right"}, {place(8), place(24)});
  EXPECT_NEAR(weights.values(0, 0), 1.0, 1e-6);
  EXPECT_NEAR(weights.values(1, 1), 7.5 / 16.0, 0.004);  // half a texel of the 230 across the cell at either end
}

TEST(MarkerWeights, CellsMatchABruteForceAverage) {
  const rig::Actor actor = SmallFace::actor(2, 2, 25.0);
  const auto places = SmallFace::places(4);
  CellOptions options;
  options.size = 256;
  const auto weights = marker_weights(actor, SmallFace::labels(places.size()), places, options);
  // Without masks on disk the map is the interpolated vertex masks: sample them over a fine grid of the patch.
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(16, 4);
  Points at = SmallFace::positions(actor, places, actor.neutral());
  const int n = 400;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const double x = -80.0 + 160.0 * (i + 0.5) / n, y = -80.0 + 160.0 * (j + 0.5) / n;
      Eigen::Index q;
      (at.leftCols<2>().rowwise() - Eigen::RowVector2d(x, y)).rowwise().squaredNorm().minCoeff(&q);
      const double right = 0.5 * (1 + std::tanh(x / 25.0)), up = 0.5 * (1 + std::tanh(y / 25.0));
      sums.row(q) += Eigen::RowVector4d((1 - up) * (1 - right), (1 - up) * right, up * (1 - right), up * right);
    }
  }
  for (int q = 0; q < 16; ++q) sums.row(q) /= sums.row(q).sum();
  EXPECT_LE((weights.values - sums).cwiseAbs().maxCoeff(), 0.01);  // 256 texels a side, linear between vertices
}

TEST(MarkerWeights, CellsEndAtTheBorderOfTheFaceSet) {
  rig::Actor actor = SmallFace::actor(2, 1, 0.0);
  TopologyData data = actor.topology->data();
  const Points& points = actor.neutral();
  for (int v = 0; v < data.vertex_count; ++v) {
    if (points(v, 0) <= 0.0) data.sets["face"].push_back(v);
  }
  const int quads = SmallFace::kSide - 1;
  const std::vector<SurfacePoint> one = {{2 * (16 * quads + 8), Eigen::Vector3d(1, 0, 0)}};
  // Alone on the patch the marker's cell is everything: half in each region. Within the face it is region 0.
  EXPECT_NEAR(marker_weights(actor, {"m"}, one).values(0, 0), 0.5, 0.05);
  actor.topology = Topology::make(data);
  EXPECT_GT(marker_weights(actor, {"m"}, one).values(0, 0), 0.95);
}

TEST(MarkerWeights, MarkersOnOneTexelTakeTheMasksAtTheirPlace) {
  const rig::Actor actor = SmallFace::actor(2, 1, 15.0);
  const SurfacePoint place = SmallFace::places(5)[7];
  const auto weights = marker_weights(actor, {"a", "b"}, {place, place});
  EXPECT_EQ(weights.notes.size(), 1u);
  EXPECT_NEAR(weights.values.row(1).sum(), 1.0, 1e-12);
}

TEST(MarkerWeights, OrderOfMarkersDoesNotMatter) {
  const rig::Actor actor = SmallFace::actor(3, 2, 10.0);
  auto places = SmallFace::places(6);
  const auto forward = marker_weights(actor, SmallFace::labels(places.size()), places);
  std::reverse(places.begin(), places.end());
  const auto backward = marker_weights(actor, SmallFace::labels(places.size()), places);
  // Texels exactly between two markers go to the first listed.
  EXPECT_LE((forward.values.colwise().reverse() - backward.values).cwiseAbs().maxCoeff(), 0.03);
}

TEST(MarkerWeights, NoRegionsMeansGlobal) {
  rig::Actor actor = SmallFace::actor();
  actor.regions.clear();
  const auto weights = marker_weights(actor, {"a"}, {SmallFace::places(5)[3]});
  EXPECT_EQ(weights.regions, std::vector<std::string>{"whole"});
  EXPECT_EQ(weights.values(0, 0), 1.0);
}

TEST(MarkerWeights, PlacesOffTheTopologyAreRefused) {
  const rig::Actor actor = SmallFace::actor();
  EXPECT_THROW(marker_weights(actor, {"a"}, {SurfacePoint{}}), InputError);
  EXPECT_THROW(marker_weights(actor, {"a", "b"}, {SmallFace::places(5)[3]}), InputError);
}

}  // namespace
}  // namespace vultus::retarget
