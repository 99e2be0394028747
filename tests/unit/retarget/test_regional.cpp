#include "retarget/regional.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "core/error.h"
#include "retarget/errors.h"
#include "retarget/face.h"
#include "small_face.h"

namespace vultus::retarget {
namespace {

using testing::SmallFace;

/// A rig, markers on it and a take made by moving the rig's own face.
struct Performance {
  explicit Performance(rig::Actor rig, int frames = 40, int side = 8)
      : actor(std::move(rig)),
        places(SmallFace::places(side)),
        labels(SmallFace::labels(places.size())),
        basis(basis_from_surface(actor, labels, places)),
        counts(marker_weights(actor, labels, places)),
        truth(SmallFace::asymmetric(actor, frames, 5)) {
    const Face face(actor, truth.poses, truth.regions);
    std::vector<Points> positions;
    for (int f = 0; f < frames; ++f) positions.push_back(SmallFace::positions(actor, places, face.at(truth, f)));
    take = SmallFace::take(labels, positions);
  }

  rig::Actor actor;
  std::vector<SurfacePoint> places;
  std::vector<std::string> labels;
  MarkerBasis basis;
  MarkerWeights counts;
  Weights truth;
  mocap::Take take;
};

SolveOptions published() {
  SolveOptions options;
  options.marker_floor = options.rest_cost = 0.0;
  return options;
}

double largest_difference(const Weights& a, const Weights& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    largest = std::max(largest, std::abs(static_cast<double>(a.values[i]) - b.values[i]));
  }
  return largest;
}

double mean_error(const Performance& p, const MarkerWeights& counts, const Weights& weights) {
  return summarize(marker_errors(p.take, p.basis, counts, weights), "", 1).mean;
}

TEST(Regional, RecoversKnownWeightsOfHardRegions) {
  const Performance p(SmallFace::actor(2, 2, 0.0));
  // Cells of markers beside a border reach over it, so only the solve with exact shares can recover the truth.
  MarkerWeights exact = p.counts;
  for (std::size_t q = 0; q < p.labels.size(); ++q) {
    const auto row = static_cast<Eigen::Index>(q);
    const int vertex = p.actor.topology->triangles()(p.places[q].triangle, 0);
    for (Eigen::Index k = 0; k < exact.values.cols(); ++k) {
      exact.values(row, k) = p.actor.regions[static_cast<std::size_t>(k)].vertex_mask[vertex];
    }
  }
  const SolveResult result = solve_take(p.take, p.basis, exact, published());
  EXPECT_LE(result.worst_kkt_residual, 1e-9);
  // float32 samples of 0.1 m are rounded to 4e-6 mm; the poses are some mm and well apart.
  EXPECT_LE(largest_difference(result.weights, p.truth), 2e-4);
  EXPECT_LE(mean_error(p, exact, result.weights), 1e-4);
}

TEST(Regional, GlobalRecoversASymmetricTake) {
  rig::Actor actor = SmallFace::actor(1, 1, 0.0);
  actor.regions.front().name = "whole";
  const Performance p(actor);
  const SolveResult result = solve_take(p.take, p.basis, MarkerWeights::global(p.labels), published());
  EXPECT_LE(largest_difference(result.weights, p.truth), 2e-4);
}

TEST(Regional, RowsLieOnTheSimplex) {
  const Performance p(SmallFace::actor(2, 2, 20.0));
  SolveOptions options;
  options.smoothing = 0.03;
  const SolveResult result = solve_take(p.take, p.basis, p.counts, options);
  for (int f = 0; f < result.weights.frames(); ++f) {
    for (int k = 0; k < 4; ++k) {
      double sum = 0.0;
      for (float w : result.weights.at(f, k)) {
        ASSERT_GE(w, 0.0f);
        sum += w;
      }
      ASSERT_NEAR(sum, 1.0, 1e-6);
    }
  }
}

TEST(Regional, HardRegionsNeverDoWorseThanGlobal) {
  // With 0/1 shares each region minimizes its own part of the sum that the global solve minimizes with one weight
  // vector for all, so the sum of squares cannot rise.
  const Performance p(SmallFace::actor(2, 2, 0.0));
  MarkerWeights hard = p.counts;
  for (Eigen::Index q = 0; q < hard.values.rows(); ++q) {
    Eigen::Index best;
    hard.values.row(q).maxCoeff(&best);
    hard.values.row(q).setZero();
    hard.values(q, best) = 1.0;
  }
  const auto global_counts = MarkerWeights::global(p.labels);
  const auto regional = marker_errors(p.take, p.basis, hard, solve_take(p.take, p.basis, hard, published()).weights);
  const auto global = marker_errors(p.take, p.basis, global_counts,
                                    solve_take(p.take, p.basis, global_counts, published()).weights);
  for (int f = 0; f < p.take.frames(); ++f) {
    double regional_sum = 0.0, global_sum = 0.0;
    for (int q = 0; q < p.basis.markers(); ++q) {
      regional_sum += std::pow(regional.at(f, q), 2);
      global_sum += std::pow(global.at(f, q), 2);
    }
    ASSERT_LE(regional_sum, global_sum + 1e-6) << "frame " << f;
  }
}

TEST(Regional, SoftRegionsBeatGlobalOnAnAsymmetricTake) {
  const Performance p(SmallFace::actor(2, 3, 12.0), 60);
  const auto global_counts = MarkerWeights::global(p.labels);
  const double global = mean_error(p, global_counts, solve_take(p.take, p.basis, global_counts).weights);
  const double regional = mean_error(p, p.counts, solve_take(p.take, p.basis, p.counts).weights);
  EXPECT_GT(global, 0.3);  // the take is truly asymmetric
  EXPECT_LT(regional, 0.5 * global);
}

TEST(Regional, OrderOfMarkersDoesNotMatter) {
  const Performance p(SmallFace::actor(2, 2, 20.0), 20);
  const SolveResult plain = solve_take(p.take, p.basis, p.counts);
  std::vector<std::string> reversed(p.labels.rbegin(), p.labels.rend());
  std::vector<SurfacePoint> places(p.places.rbegin(), p.places.rend());
  mocap::Take take = mocap::Take::empty("reversed", 60.0, reversed, p.take.frames());
  const int count = take.markers();
  for (int f = 0; f < take.frames(); ++f) {
    for (int q = 0; q < count; ++q) take.set(f, q, p.take.at(f, count - 1 - q));
  }
  const SolveResult other = solve_take(take, basis_from_surface(p.actor, reversed, places),
                                       marker_weights(p.actor, reversed, places));
  EXPECT_LE(largest_difference(plain.weights, other.weights), 1e-5);  // other order of sums
  const SolveResult mixed = solve_take(take, p.basis, p.counts);      // only the take's columns in another order
  EXPECT_EQ(mixed.weights.values, plain.weights.values);
}

TEST(Regional, MissingMarkersCountNothing) {
  Performance p(SmallFace::actor(2, 1, 15.0), 20);
  // A dropped sample's stored position must not matter, and the truth must still come out of the others.
  Performance dropped = p;
  Random random(3);
  for (int f = 0; f < p.take.frames(); ++f) {
    for (int q = 0; q < p.take.markers(); ++q) {
      if (random.uniform() > 0.2) continue;
      p.take.set(f, q, {1e4, -1e4, 1e4});
      p.take.drop(f, q);
      dropped.take.set(f, q, {0, 0, 0});
      dropped.take.drop(f, q);
    }
  }
  const SolveResult a = solve_take(p.take, p.basis, p.counts);
  const SolveResult b = solve_take(dropped.take, dropped.basis, dropped.counts);
  EXPECT_EQ(a.weights.values, b.weights.values);
  EXPECT_LE(a.worst_kkt_residual, 1e-9);
  EXPECT_LE(mean_error(p, p.counts, a.weights), 0.35);
  const auto errors = marker_errors(p.take, p.basis, p.counts, a.weights);
  for (int f = 0; f < p.take.frames(); ++f) {
    for (int q = 0; q < p.take.markers(); ++q) ASSERT_EQ(std::isnan(errors.at(f, q)), !p.take.has(f, q));
  }
}

TEST(Regional, AnUnseenRegionIsBridgedInTime) {
  Performance p(SmallFace::actor(2, 1, 0.0), 12);
  MarkerWeights hard = p.counts;
  for (Eigen::Index q = 0; q < hard.values.rows(); ++q) {
    const bool left = p.basis.at(static_cast<int>(q), 0).x() > 0.0;
    hard.values.row(q) << (left ? 0.0 : 1.0), (left ? 1.0 : 0.0);
  }
  for (int f = 4; f < 8; ++f) {
    for (int q = 0; q < p.take.markers(); ++q) {
      if (hard.values(q, 1) > 0.0) p.take.drop(f, q);
    }
  }
  const SolveResult result = solve_take(p.take, p.basis, hard, published());
  for (int f = 0; f < 12; ++f) {
    EXPECT_EQ(result.bridged[2 * f], 0);
    EXPECT_EQ(result.bridged[2 * f + 1], f >= 4 && f < 8 ? 1 : 0) << f;
  }
  const auto before = std::as_const(result.weights).at(3, 1), after = std::as_const(result.weights).at(8, 1);
  const auto middle = std::as_const(result.weights).at(5, 1);
  for (std::size_t i = 0; i < middle.size(); ++i) EXPECT_NEAR(middle[i], 0.6f * before[i] + 0.4f * after[i], 1e-6f);
}

TEST(Regional, ARegionThatNeverSeesAMarkerStaysNeutral) {
  Performance p(SmallFace::actor(2, 1, 15.0), 5);
  MarkerWeights counts = p.counts;
  counts.values.col(0).setOnes();
  counts.values.col(1).setZero();
  const SolveResult result = solve_take(p.take, p.basis, counts);
  for (int f = 0; f < 5; ++f) EXPECT_EQ(result.weights.at(f, 1)[0], 1.0f);
  EXPECT_FALSE(result.notes.empty());
}

TEST(Regional, ThreadsAndSplitsChangeNoBit) {
  const Performance p(SmallFace::actor(2, 2, 20.0), 150);
  const SolveResult parallel = solve_take(p.take, p.basis, p.counts);
  tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const SolveResult serial = solve_take(p.take, p.basis, p.counts);
  EXPECT_EQ(parallel.weights.values, serial.weights.values);
  mocap::Take part = mocap::Take::empty("part", 60.0, p.labels, 50);
  for (int f = 0; f < 50; ++f) {
    for (int q = 0; q < part.markers(); ++q) part.set(f, q, p.take.at(f + 77, q));
  }
  const SolveResult split = solve_take(part, p.basis, p.counts);
  const std::size_t stride = p.actor.regions.size() * p.actor.poses.size();
  EXPECT_TRUE(std::equal(split.weights.values.begin(), split.weights.values.end(),
                         parallel.weights.values.begin() + static_cast<std::ptrdiff_t>(77 * stride)));
}

TEST(Regional, FloorDecidesWhatARegionsOwnMarkersLeaveOpen) {
  // One marker only in region 1: three equations for six poses. With the floor the answer is unique and follows the
  // face's other markers, which see the truth.
  Performance p(SmallFace::actor(1, 1, 0.0), 20);
  MarkerWeights counts = p.counts;
  counts.regions = {"rest", "spot"};
  counts.values = Eigen::MatrixXd::Zero(p.basis.markers(), 2);
  counts.values.col(0).setOnes();
  counts.values.row(12) << 0.0, 1.0;
  SolveOptions floor = published();
  floor.marker_floor = 0.01;
  const SolveResult result = solve_take(p.take, p.basis, counts, floor);
  for (int f = 0; f < 20; ++f) {
    for (std::size_t i = 0; i < p.truth.poses.size(); ++i) {
      EXPECT_NEAR(result.weights.at(f, 1)[i], p.truth.at(f, 0)[i], 5e-3);
    }
  }
}

TEST(Regional, APoseThatMovesNoMarkerGetsNoWeight) {
  // Two more poses of the face are the neutral itself: without a cost they are as good as the neutral.
  Performance p(SmallFace::actor(1, 1, 0.0), 10);
  for (const char* name : {"idle_a", "idle_b"}) {
    p.actor.poses.push_back({name, {}, p.actor.neutral()});
  }
  const MarkerBasis basis = basis_from_surface(p.actor, p.labels, p.places);
  SolveOptions options = published();
  options.rest_cost = 1e-3;
  const SolveResult result = solve_take(p.take, basis, p.counts, options);
  for (int f = 0; f < 10; ++f) {
    EXPECT_EQ(result.weights.at(f, 0)[6], 0.0f);
    EXPECT_EQ(result.weights.at(f, 0)[7], 0.0f);
    // A cost of 1e-3 mm² against poses of some mm on some ten markers moves weights by less than 1e-4.
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(result.weights.at(f, 0)[i], p.truth.at(f, 0)[i], 3e-4);
  }
}

TEST(Regional, UncapturedPosesKeepWeightZero) {
  Performance p(SmallFace::actor(2, 1, 15.0), 10);
  p.basis.usable[2] = false;
  const SolveResult result = solve_take(p.take, p.basis, p.counts);
  for (int f = 0; f < 10; ++f) EXPECT_EQ(result.weights.at(f, 0)[2], 0.0f);
}

TEST(Regional, SmoothingIsAGaussian) {
  Weights weights = Weights::zeros(100.0, {"whole"}, {"neutral", "a"}, 41);
  for (int f = 0; f < 41; ++f) weights.at(f, 0)[f == 20 ? 1 : 0] = 1.0f;
  smooth(weights, 0.02);  // 2 frames
  double sum = 0.0;
  for (int f = 0; f < 41; ++f) sum += weights.at(f, 0)[1];
  EXPECT_NEAR(sum, 1.0, 1e-5);
  EXPECT_NEAR(weights.at(20, 0)[1], 1.0 / (2.0 * std::sqrt(2.0 * M_PI)), 1e-4);
  EXPECT_NEAR(weights.at(22, 0)[1] / weights.at(20, 0)[1], std::exp(-0.5), 1e-4);
  EXPECT_EQ(weights.at(0, 0)[0], 1.0f);
}

TEST(Regional, BadInputIsRefused) {
  Performance p(SmallFace::actor(2, 1, 15.0), 3);
  SolveOptions options;
  options.smoothing = -1.0;
  EXPECT_THROW(solve_take(p.take, p.basis, p.counts, options), InputError);
  options = {};
  options.rest_cost = -0.1;
  EXPECT_THROW(solve_take(p.take, p.basis, p.counts, options), InputError);
  options = {};
  options.marker_floor = 1.5;
  EXPECT_THROW(solve_take(p.take, p.basis, p.counts, options), InputError);
  for (std::string& label : p.take.labels) label = "x" + label;
  EXPECT_THROW(solve_take(p.take, p.basis, p.counts), InputError);
}

}  // namespace
}  // namespace vultus::retarget
