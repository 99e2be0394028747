#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/error.h"
#include "core/neighbours.h"
#include "core/random.h"
#include "core/texture_space.h"
#include "rig/attachments.h"
#include "rig/kmeans.h"
#include "rig/region_masks.h"
#include "rig/segmentation.h"
#include "tests/unit/rig/plates.h"

namespace vultus::rig {
namespace {

TEST(KMeans, SeparatesClumps) {
  Random random(3);
  Eigen::MatrixXd rows(300, 2);
  for (int i = 0; i < 300; ++i) rows.row(i) << 10.0 * (i % 3) + random.normal() * 0.1, random.normal() * 0.1;
  const KMeansResult result = k_means(rows, Eigen::VectorXd::Ones(300), 3, 1);
  EXPECT_TRUE(result.converged);
  for (int i = 0; i < 300; ++i) EXPECT_EQ(result.labels[i], i % 3) << "clusters are numbered by their first row";
  EXPECT_LT(result.inertia, 300 * 2 * 0.02);  // variance 0.01 on either axis
}

TEST(KMeans, MoreClustersThanDifferentRowsAreNotInvented) {
  Eigen::MatrixXd rows(6, 1);
  rows << 1, 1, 2, 2, 1, 2;
  const KMeansResult result = k_means(rows, Eigen::VectorXd::Ones(6), 5, 9);
  EXPECT_EQ(result.centres.rows(), 2);
  EXPECT_NEAR(result.inertia, 0.0, 1e-12);
}

TEST(MotionField, FindsDirectionAndDeviation) {
  Points rest = Points::Zero(2, 3), up = rest, down = rest;
  up.row(0) << 3, 4, 0;  // 5 mm along (0.6, 0.8, 0)
  down.row(0) << -3, -4, 0;
  const Points* poses[] = {&rest, &up, &down};
  const MotionField field = motion_field(poses);
  EXPECT_NEAR(std::abs(field.directions.row(0).dot(Eigen::RowVector3d(0.6, 0.8, 0.0))), 1.0, 1e-12);
  EXPECT_NEAR(field.deviation[0], std::sqrt(50.0 / 3.0), 1e-9);
  EXPECT_NEAR(field.certainty[0], 1.0, 1e-9);
  EXPECT_NEAR(field.range[0], 5.0, 1e-12);
  EXPECT_EQ(field.directions.row(1), Eigen::RowVector3d::Zero());
  EXPECT_THROW(motion_field(std::span(poses, 1)), InputError);
}

/// A field that turns slowly over the sheet, its signs drawn at random: coordination must bring back one sign.
TEST(MotionField, CoordinationFlipsSignsCoherently) {
  const Actor plate = moving_plates(24, 24, {});
  const Adjacency neighbours = adjacency(*plate.topology);
  MotionField field;
  const int count = plate.topology->vertex_count();
  field.directions.resize(count, 3);
  field.deviation = field.certainty = field.range = Eigen::VectorXd::Ones(count);
  Random random(5);
  double best = 0.0;
  for (int v = 0; v < count; ++v) {
    const double angle = 0.04 * plate.neutral()(v, 0);
    field.directions.row(v) << std::sin(angle), std::cos(angle), 0.0;
  }
  for (int v = 0; v < count; ++v)
    for (int n : neighbours.of(v))
      if (n > v) best -= field.directions.row(v).dot(field.directions.row(n));
  const Points expected = field.directions;
  for (int v = 0; v < count; ++v)
    if (random.uniform() < 0.5) field.directions.row(v) *= -1.0;
  const Coordination result = coordinate_signs(field, neighbours);
  EXPECT_GT(result.initial_energy, 0.5 * best);
  EXPECT_NEAR(result.final_energy, best, 1e-9);
  EXPECT_LT((field.directions - expected).cwiseAbs().maxCoeff(), 1e-12);
}

/// Of the vertices of each plate's middle, the share that has the region of most of them.
double recovered(const Segmentation& result, const std::vector<int>& truth) {
  std::map<int, std::map<int, int>> counts;
  int inside = 0, right = 0;
  for (std::size_t v = 0; v < truth.size(); ++v)
    if (truth[v] >= 0) ++counts[truth[v]][result.labels[v]];
  std::set<int> used;
  for (const auto& [plate, labels] : counts) {
    int most = 0, total = 0, label = -1;
    for (const auto& [l, n] : labels) {
      total += n;
      if (n > most) std::tie(most, label) = std::pair(n, l);
    }
    inside += total;
    if (used.insert(label).second) right += most;
  }
  return static_cast<double>(right) / inside;
}

bool contiguous(const Actor& actor, const Segmentation& result) {
  const Adjacency neighbours = adjacency(*actor.topology);
  std::set<int> seen_labels;
  std::vector<bool> seen(result.labels.size(), false);
  for (int first = 0; first < static_cast<int>(seen.size()); ++first) {
    if (seen[first]) continue;
    if (!seen_labels.insert(result.labels[first]).second) return false;
    std::vector<int> open = {first};
    seen[first] = true;
    while (!open.empty()) {
      const int v = open.back();
      open.pop_back();
      for (int n : neighbours.of(v))
        if (!seen[n] && result.labels[n] == result.labels[first]) {
          seen[n] = true;
          open.push_back(n);
        }
    }
  }
  return true;
}

class SegmentationMethods : public testing::TestWithParam<SegmentationMethod> {};

TEST_P(SegmentationMethods, RecoverPatchesThatMoveApart) {
  const std::vector<Plate> plates = {{8, 8, {0, 3, 0}}, {24, 8, {0, 0, 3}}, {8, 24, {3, 0, 0}}, {24, 24, {2, 2, 1}}};
  const Actor actor = moving_plates(32, 32, plates);
  SegmentationOptions options;
  options.method = GetParam();
  options.regions = 4;
  options.symmetric = false;
  const Segmentation result = segment(actor, options);
  EXPECT_EQ(result.regions, 4);
  EXPECT_TRUE(contiguous(actor, result));
  EXPECT_GT(recovered(result, plate_truth(actor, plates)), 0.97);
}

TEST_P(SegmentationMethods, GiveTheAskedNumberOfContiguousRegions) {
  const std::vector<Plate> plates = {
      {6, 10, {0, 3, 0}}, {20, 8, {0, 1, 3}}, {8, 26, {3, 0, 1}}, {26, 22, {2, -2, 1}}, {16, 17, {-1, 2, -2}}};
  const Actor actor = moving_plates(32, 32, plates);
  for (int regions : {2, 3, 5}) {
    SegmentationOptions options;
    options.method = GetParam();
    options.regions = regions;
    options.symmetric = false;
    const Segmentation result = segment(actor, options);
    EXPECT_EQ(result.regions, regions);
    EXPECT_TRUE(contiguous(actor, result)) << regions;
    const std::set<int> used(result.labels.begin(), result.labels.end());
    EXPECT_EQ(static_cast<int>(used.size()), regions);
  }
}

TEST_P(SegmentationMethods, StopAtTheVertexThreshold) {
  const std::vector<Plate> plates = {{8, 8, {0, 3, 0}}, {24, 8, {0, 0, 3}}, {8, 24, {3, 0, 0}}, {24, 24, {2, 2, 1}}};
  const Actor actor = moving_plates(32, 32, plates);
  SegmentationOptions options;
  options.method = GetParam();
  options.regions = 0;
  options.min_vertices = 150;
  options.symmetric = false;
  const Segmentation result = segment(actor, options);
  std::vector<int> size(result.regions, 0);
  for (std::size_t v = 0; v < result.labels.size(); ++v) size[result.labels[v]] += 1;
  EXPECT_GE(*std::min_element(size.begin(), size.end()), 150);
  EXPECT_GE(result.regions, 2);
}

INSTANTIATE_TEST_SUITE_P(Both, SegmentationMethods,
                         testing::Values(SegmentationMethod::motion, SegmentationMethod::liu));

TEST(Segmentation, IsSymmetricWhenAsked) {
  // Plates in mirrored pairs and one across the middle, moving differently on either side.
  const std::vector<Plate> plates = {
      {6, 8, {0, 3, 0}}, {26, 8, {0, 2, 1}}, {6, 24, {2, 0, 1}}, {26, 24, {-2, 1, 1}}, {16, 16, {0, -2, 2}}};
  const Actor actor = moving_plates(33, 32, plates);
  const std::vector<int> mirror = mirrored_vertices(actor);
  for (int regions : {3, 4, 5, 7}) {
    SegmentationOptions options;
    options.regions = regions;
    const Segmentation result = segment(actor, options);
    EXPECT_EQ(result.regions, regions);
    std::map<int, int> other;
    int broken = 0;
    for (std::size_t v = 0; v < mirror.size(); ++v) {
      if (mirror[v] == static_cast<int>(v)) continue;
      const auto [entry, added] = other.try_emplace(result.labels[v], result.labels[mirror[v]]);
      broken += entry->second != result.labels[mirror[v]] ? 1 : 0;
    }
    // What does not move follows the nearest region, where the middle line may be given to either side. Of two pairs
    // and a middle, seven regions cannot be made symmetrically.
    if (regions < 7) {
      EXPECT_LE(broken, 4) << regions;
    }
  }
}

TEST(Segmentation, DoesNotDependOnTheRun) {
  const std::vector<Plate> plates = {{8, 8, {0, 3, 0}}, {24, 8, {0, 0, 3}}, {8, 24, {3, 0, 0}}, {24, 24, {2, 2, 1}}};
  const Actor actor = moving_plates(32, 32, plates);
  EXPECT_EQ(segment(actor).labels, segment(actor).labels);
}

TEST(Segmentation, RefusesWhatCannotBeDivided) {
  EXPECT_THROW(segment(moving_plates(16, 16, {})), InputError) << "nothing moves";
  SegmentationOptions options;
  options.regions = -1;
  EXPECT_THROW(options.validate(), InputError);
  options.regions = 200;
  EXPECT_THROW(segment(moving_plates(16, 16, {{8, 8, {0, 1, 0}}}), options), InputError) << "too few ways of moving";
}

TEST(Attachments, PartsFollowTheSkinThatMovesLikeThem) {
  const std::vector<Plate> plates = {{8, 8, {0, 3, 0}}, {24, 24, {3, 0, 0}}};
  const Actor actor = with_loose_parts(moving_plates(32, 32, plates), {0, 3, 0});
  std::vector<const Points*> poses;
  for (const Pose& pose : actor.poses) poses.push_back(&pose.positions);
  const std::vector<bool> skin = skin_vertices(*actor.topology);
  const std::vector<int> follows = attachments(*actor.topology, poses, skin);
  const int loose = 32 * 32;
  EXPECT_TRUE(skin[0]);
  EXPECT_FALSE(skin[loose]);
  EXPECT_EQ(follows[0], -1);
  // The moving part hangs over the still corner but moves like the middle of the first plate.
  const Eigen::RowVector3d leader = actor.neutral().row(follows[loose]);
  EXPECT_LT((leader - Eigen::RowVector3d(8 - 15.5, 8 - 15.5, 0)).norm(), 5.01) << "5 mm is the plate's radius";
  for (int i = 1; i < 4; ++i) EXPECT_EQ(follows[loose + i], follows[loose]) << "a rigid part follows as a whole";
  // The still part follows the nearest skin.
  EXPECT_LT((actor.neutral().row(follows[loose + 4]) - actor.neutral().row(loose + 4)).norm(), 4.0);
}

class Masks : public testing::Test {
 protected:
  static Actor actor() {
    return with_loose_parts(
        moving_plates(33, 32, {{8, 8, {0, 3, 0}}, {24, 8, {0, 0, 3}}, {8, 24, {3, 0, 0}}, {24, 24, {2, 2, 1}}}),
        {0, 3, 0});
  }
};

TEST_F(Masks, SumToOneAtEveryTexelAndVertex) {
  const Actor plate = actor();
  SegmentationOptions options;
  options.regions = 4;
  options.symmetric = false;
  for (double blend : {0.0, 1.0, 4.0, 80.0}) {
    const RegionMasks masks = region_masks(plate, segment(plate, options), {64, blend});
    ASSERT_EQ(masks.regions.size(), 4U);
    EXPECT_EQ(masks.masks.channels(), 4);
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        const float* texel = masks.masks.at(x, y);
        EXPECT_NEAR(texel[0] + texel[1] + texel[2] + texel[3], 1.0F, 1e-5F);
        EXPECT_GE(*std::min_element(texel, texel + 4), 0.0F);
      }
    Eigen::VectorXf sum = Eigen::VectorXf::Zero(plate.topology->vertex_count());
    for (const Region& region : masks.regions) sum += region.vertex_mask;
    EXPECT_LT((sum.array() - 1.0F).abs().maxCoeff(), 1e-5F);
  }
}

TEST_F(Masks, AreHardWithoutBlendingAndWiderWithMore) {
  const Actor plate = actor();
  SegmentationOptions options;
  options.regions = 4;
  options.symmetric = false;
  const Segmentation division = segment(plate, options);
  double last = 0.0;
  for (double blend : {0.0, 1.0, 3.0}) {
    const RegionMasks masks = region_masks(plate, division, {128, blend});
    double mixed = 0.0;  // mean of 1 − Σ m², 0 for hard masks
    for (int v = 0; v < 33 * 32; ++v) {
      double squares = 0.0;
      for (const Region& region : masks.regions) squares += region.vertex_mask[v] * region.vertex_mask[v];
      mixed += (1.0 - squares) / (33 * 32);
    }
    if (blend == 0.0) {
      EXPECT_LT(mixed, 0.05);  // only the bilinear look-up mixes, in one row of vertices along borders
    } else {
      EXPECT_GT(mixed, last + 0.02);
    }
    last = mixed;
  }
}

/// The sheet is cut in two charts whose places on the texture are far from each other and, on the other side, has a
/// stranger beside it: the seam must not show, the stranger must not bleed in.
TEST_F(Masks, AreContinuousAcrossSeamsAndDoNotBleedBetweenCharts) {
  const Actor plate = two_charts(moving_plates(32, 32, {{8, 16, {0, 3, 0}}, {24, 16, {0, 0, 3}}}));
  Segmentation division;
  division.labels.assign(32 * 32, 0);
  division.regions = 2;
  division.moving.assign(32 * 32, true);
  division.follows.assign(32 * 32, -1);
  division.field.range = Eigen::VectorXd::Ones(32 * 32);
  for (int v = 0; v < 32 * 32; ++v) division.labels[v] = plate.neutral()(v, 1) > 0.0 ? 1 : 0;
  const RegionMasks masks = region_masks(plate, division, {128, 2.0});
  const TextureSpace texels(plate.topology, 128, 128);
  // Far from the border in y every chart shows its own region alone.
  for (int v = 0; v < 32 * 32; ++v)
    if (std::abs(plate.neutral()(v, 1)) > 10.0) {
      EXPECT_GT(masks.regions[division.labels[v]].vertex_mask[v], 0.99F) << v;
    }
  // On both sides of the seam at x = 0 texels agree with the vertices between them.
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 128; ++x) {
      const SurfacePoint& place = texels.at(x, y);
      if (!place.valid()) continue;
      const Eigen::Vector3d position = position_of(place, *plate.topology, plate.neutral());
      if (std::abs(position.x()) > 0.4) continue;
      float interpolated = 0.0F;
      for (int k = 0; k < 3; ++k)
        interpolated += static_cast<float>(place.barycentric[k]) *
                        masks.regions[0].vertex_mask[plate.topology->triangles()(place.triangle, k)];
      EXPECT_NEAR(masks.masks.at(x, y)[0], interpolated, 0.06F);
    }
}

TEST_F(Masks, PaintOverridesAndIsNormalized) {
  const Actor plate = actor();
  Image paint(32, 32, {"a", "b"});
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) paint.at(x, y)[x < 16 ? 0 : 1] = 3.0F;
  const RegionMasks masks = painted_masks(*plate.topology, paint);
  EXPECT_EQ(masks.regions[1].name, "b");
  EXPECT_FLOAT_EQ(masks.masks.at(2, 2)[0], 1.0F);
  const Eigen::VectorXf sum = masks.regions[0].vertex_mask + masks.regions[1].vertex_mask;
  EXPECT_LT((sum.array() - 1.0F).abs().maxCoeff(), 1e-5F);
  std::fill(paint.pixels().begin(), paint.pixels().end(), 0.0F);
  EXPECT_THROW(painted_masks(*plate.topology, paint), InputError);
}

TEST_F(Masks, OneRegionIsTheWholeFace) {
  Actor plate = actor();
  SegmentationOptions options;
  options.regions = 1;
  divide_face(plate, options);
  ASSERT_EQ(plate.regions.size(), 1U);
  EXPECT_EQ(plate.regions[0].name, "whole");
  EXPECT_EQ(plate.regions[0].vertex_mask.minCoeff(), 1.0F);
  EXPECT_EQ(plate.region_masks.at(3, 3)[0], 1.0F);
}

}  // namespace
}  // namespace vultus::rig
