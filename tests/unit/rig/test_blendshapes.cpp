#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"
#include "rig/blendshapes.h"

namespace vultus::rig {
namespace {

/// A row of triangles with `vertices` vertices, `poses` random poses and two masks that sum to one.
Actor random_actor(int vertices, int poses) {
  Random random(7);
  Triangles triangles(vertices - 2, 3);
  for (int t = 0; t < triangles.rows(); ++t) triangles.row(t) << t, t + 1, t + 2;
  Actor actor;
  actor.name = "row";
  actor.topology = Topology::from_triangles(vertices, triangles);
  for (int p = 0; p < poses; ++p) {
    Pose pose{p == 0 ? "neutral" : "pose" + std::to_string(p), {}, Points::Zero(vertices, 3)};
    for (int v = 0; v < vertices; ++v)
      for (int axis = 0; axis < 3; ++axis) pose.positions(v, axis) = random.uniform(-100.0, 100.0);
    // A pose that moves only the first vertices, so that blocks are skipped.
    if (p == 2) pose.positions.bottomRows(vertices - 10) = actor.poses[0].positions.bottomRows(vertices - 10);
    actor.poses.push_back(std::move(pose));
  }
  Region left{"left", Eigen::VectorXf(vertices)}, right{"right", Eigen::VectorXf(vertices)};
  for (int v = 0; v < vertices; ++v) {
    left.vertex_mask[v] = static_cast<float>(std::min(1.0, std::max(0.0, random.uniform(-0.5, 1.5))));
    right.vertex_mask[v] = 1.0F - left.vertex_mask[v];
  }
  actor.regions = {left, right};
  return actor;
}

/// Liu eq. 3 as it is written.
Points by_definition(const Actor& actor, const std::vector<float>& weights) {
  Points sum = Points::Zero(actor.topology->vertex_count(), 3);
  const std::size_t poses = actor.poses.size();
  for (std::size_t k = 0; k < actor.regions.size(); ++k)
    for (std::size_t p = 0; p < poses; ++p)
      for (int v = 0; v < sum.rows(); ++v)
        sum.row(v) += static_cast<double>(actor.regions[k].vertex_mask[v] * weights[k * poses + p]) *
                      actor.poses[p].positions.row(v);
  return sum;
}

// Coordinates are at most 100 mm and a handful of float32 terms is added: 1e-4 mm is some ten roundings.
constexpr double kFloat = 1e-4;

TEST(Blendshapes, AWholePoseIsItself) {
  const Actor actor = random_actor(700, 4);
  const Blendshapes shapes(actor, actor.pose_names());
  for (int p = 0; p < 4; ++p) {
    std::vector<float> weights(4, 0.0F);
    weights[p] = 1.0F;
    EXPECT_LT((shapes(weights).cast<double>() - actor.poses[p].positions).cwiseAbs().maxCoeff(), kFloat) << p;
  }
}

TEST(Blendshapes, RegionsBlendAsTheEquationSays) {
  for (int vertices : {3, 255, 256, 257, 1000}) {
    const Actor actor = random_actor(std::max(vertices, 11), 5);
    const Blendshapes shapes(actor, actor.pose_names(), {"left", "right"});
    // Neither ≥ 0 nor of sum one, which eq. 3 does not need.
    const std::vector<float> weights = {0.25F, 0.5F, 0.0F, 0.125F, 0.0F, -0.5F, 0.0F, 0.75F, 0.0F, 0.25F};
    EXPECT_LT((shapes(weights).cast<double>() - by_definition(actor, weights)).cwiseAbs().maxCoeff(), kFloat);
  }
}

TEST(Blendshapes, PosesAndRegionsFollowTheAskedOrder) {
  const Actor actor = random_actor(300, 3);
  const Blendshapes shapes(actor, {"pose2", "neutral"}, {"right"});
  const FloatPoints moved = shapes(std::vector<float>{1.0F, 0.0F});
  const Eigen::VectorXd mask = actor.regions[1].vertex_mask.cast<double>();
  const Points expected = mask.asDiagonal() * actor.poses[2].positions;
  EXPECT_LT((moved.cast<double>() - expected).cwiseAbs().maxCoeff(), kFloat);
}

TEST(Blendshapes, WrongNamesAndSizesAreRefused) {
  const Actor actor = random_actor(20, 3);
  EXPECT_THROW(Blendshapes(actor, {"pose9"}), InputError);
  EXPECT_THROW(Blendshapes(actor, {"neutral"}, {"lefft"}), InputError);
  const Blendshapes shapes(actor, actor.pose_names());
  EXPECT_THROW(shapes(std::vector<float>(2, 0.5F)), InputError);
}

}  // namespace
}  // namespace vultus::rig
