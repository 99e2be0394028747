#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "apps/bench_mocap/gap_cells.h"
#include "apps/bench_mocap/interpolation.h"
#include "apps/bench_mocap/mocap_bench.h"
#include "core/error.h"

namespace vultus::apps::bench_mocap {
namespace {

Points sampled(int first, int last, const std::function<double(double)>& path) {
  Points points(last - first + 1, 3);
  for (int f = first; f <= last; ++f) points.row(f - first) << path(f), -path(f), 7.0;
  return points;
}

TEST(Interpolation, AllThreeAreExactForStraightMotion) {
  const auto path = [](double f) { return 2.0 + 0.5 * f; };
  const Points truth = sampled(5, 9, path);
  for (const Points& filled : interpolations(sampled(0, 4, path), sampled(10, 14, path), 5)) {
    EXPECT_LT((filled - truth).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(Interpolation, PchipNeverOvershootsAndCubicFollowsCurves) {
  // Still, then a step: a cubic swings out below the step, PCHIP stays between the two levels.
  const auto step = [](double f) { return f < 12.0 ? 0.0 : 1.0 + 0.3 * (f - 12.0); };
  const auto filled = interpolations(sampled(0, 9, step), sampled(12, 21, step), 2);
  EXPECT_GE(filled[1].col(0).minCoeff(), 0.0);
  EXPECT_LE(filled[1].col(0).maxCoeff(), 1.0);
  // A parabola: with thirty knots the natural ends no longer matter (their effect falls by 0.27 a knot).
  const auto parabola = [](double f) { return 0.01 * f * f; };
  const Points truth = sampled(30, 34, parabola);
  const auto curved = interpolations(sampled(0, 29, parabola), sampled(35, 64, parabola), 5);
  EXPECT_LT((curved[2] - truth).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_GT((curved[0] - truth).cwiseAbs().maxCoeff(), 0.05);  // a chord of 6 frames sags by 0.01 * 9
}

TEST(GapCells, FilledGapsAreComparedWithTheTruth) {
  // Twelve markers that all follow one swing: the rest of the face tells where the hidden one is.
  std::vector<std::string> labels;
  for (int m = 0; m < 12; ++m) labels.push_back("m" + std::to_string(m));
  mocap::Take take = mocap::Take::empty("swing", 60.0, labels, 400);
  for (int f = 0; f < 400; ++f) {
    const double a = std::sin(0.21 * f) + 0.6 * std::sin(0.083 * f + 1.0);
    for (int m = 0; m < 12; ++m) take.set(f, m, {20.0 * (m % 4) + 0.3 * m * a, 15.0 * (m / 4) - a, (m % 3) * a});
  }
  const GapCell cell = measure_cell({take}, 0.5, 3, 20, 1, Progress::none());
  EXPECT_EQ(cell.trials, 20);
  EXPECT_EQ(cell.samples + cell.holes, 20.0 * 3 * 30);
  EXPECT_LT(cell.ratio(), 0.2);  // a linear law; interpolation misses the swing's turns
  EXPECT_GE(cell.coverage(), 0.0);
  EXPECT_LE(cell.coverage(), 1.0);
}

TEST(MocapBench, EveryKeyIsThereBeforeAnythingIsMeasured) {
  const nlohmann::json report = empty_report();
  for (const char* key : {"labels_correct", "labels_correct_in_swaps", "swaps_left", "stabilization_rms_mm", "coverage",
                          "read_seconds", "clean_seconds"}) {
    ASSERT_TRUE(report.contains(key)) << key;
    EXPECT_TRUE(report[key].is_null()) << key;
  }
  for (const char* seconds : {"0.1", "0.5", "1", "2"}) {
    for (const char* figure : {"mean_mm", "interpolation_mm", "ratio", "coverage"}) {
      EXPECT_TRUE(report["gaps"][seconds].contains(figure));
      for (const char* count : {"1", "3", "6"}) EXPECT_TRUE(report["gaps_by_count"][count][seconds].contains(figure));
    }
  }
}

TEST(MocapBench, UnknownPartsAndTooFewTrialsAreRefused) {
  MocapBenchOptions options;
  options.parts = {"gasp"};
  EXPECT_THROW(options.validate(), UsageError);
  options.parts = {"gaps"};
  EXPECT_NO_THROW(options.validate());
  options.trials = 3;
  EXPECT_THROW(options.validate(), UsageError);
}

}  // namespace
}  // namespace vultus::apps::bench_mocap
