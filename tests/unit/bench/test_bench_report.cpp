#include <gtest/gtest.h>

#include "apps/bench_registration/bench_report.h"
#include "core/error.h"

namespace vultus::apps::bench {
namespace {

CaseRow row(const std::string& person, const std::string& pose, std::vector<float> surface, std::vector<float> vertex) {
  CaseRow result;
  result.set = "ict";
  result.method = "default";
  result.person = person;
  result.pose = pose;
  result.distances = Distances{std::move(surface), std::move(vertex)};
  result.scan = {0.1F, 0.3F};
  result.clean_seconds = 1.0;
  result.register_seconds = 4.0;
  return result;
}

std::vector<SetResult> one_set() {
  SetResult ict{"ict", "", {row("a", "neutral", {0, 0.2F}, {1, 2, 3}), row("a", "jawOpen", {0.3F}, {5, 7})}};
  CaseRow failed = row("b", "neutral", {}, {});
  failed.distances.reset();
  failed.error = "no face was found";
  ict.rows.push_back(failed);
  return {ict, {"real", "no data", {}}};
}

TEST(BenchReport, EveryFigureOfEverySetAndMethodIsThere) {
  const nlohmann::json sets = sets_json(one_set());
  for (const char* set : {"virtual", "ict", "meshmonk", "real"})
    for (const char* method : {"default", "zhu", "sanchez"})
      for (const char* figure :
           {"scan_mean_mm", "scan_p95_mm", "vertex_median_mm", "vertex_p95_mm", "seconds_per_scan"}) {
        ASSERT_TRUE(sets.at(set).at(method).contains(figure)) << set << method << figure;
        const bool measured = std::string(set) == "ict" && std::string(method) == "default";
        EXPECT_EQ(sets[set][method][figure].is_number(), measured) << set << method << figure;
      }
}

TEST(BenchReport, FiguresArePooledAndFailuresCounted) {
  const nlohmann::json figures = sets_json(one_set()).at("ict").at("default");
  EXPECT_NEAR(figures.at("scan_mean_mm").get<double>(), 0.2, 1e-6);      // of the means 0.1 and 0.3
  EXPECT_NEAR(figures.at("vertex_median_mm").get<double>(), 3.0, 1e-6);  // of 1 2 3 5 7
  EXPECT_NEAR(figures.at("worst_vertex_median_mm").get<double>(), 6.0, 1e-6);
  EXPECT_NEAR(figures.at("open_jaw_vertex_p95_mm").get<double>(), 6.9, 1e-6);  // of 5 and 7
  EXPECT_NEAR(figures.at("seconds_per_scan").get<double>(), 5.0, 1e-6);
  EXPECT_NEAR(figures.at("noisy_scan_mean_mm").get<double>(), 0.2, 1e-6);
  EXPECT_EQ(figures.at("cases"), 3);
  EXPECT_EQ(figures.at("failed"), 1);
}

TEST(BenchReport, WithoutTruthTheScanItselfIsTold) {
  std::vector<SetResult> results = one_set();
  CaseRow real = row("james", "neutral", {}, {});
  real.set = "real";
  real.distances.reset();
  real.landmarks = {1, 2, 9};
  results[1] = {"real", "", {real}};
  const nlohmann::json figures = sets_json(results).at("real").at("default");
  EXPECT_NEAR(figures.at("scan_mean_mm").get<double>(), 0.2, 1e-6);
  EXPECT_TRUE(figures.at("vertex_median_mm").is_null());
  EXPECT_TRUE(figures.at("vertex_p95_mm").is_null());
  EXPECT_NEAR(figures.at("landmark_residual_mm").get<double>(), 2.0, 1e-6);
}

TEST(BenchReport, CasesAreAllThereWithTheirErrors) {
  const nlohmann::json cases = cases_json(one_set());
  ASSERT_EQ(cases.size(), 3U);
  EXPECT_EQ(cases[1].at("pose"), "jawOpen");
  EXPECT_NEAR(cases[1].at("vertex_median_mm").get<double>(), 6.0, 1e-6);
  EXPECT_EQ(cases[2].at("error"), "no face was found");
  EXPECT_NE(row_line(one_set()[0].rows[2]).find("no face was found"), std::string::npos);
  EXPECT_EQ(table_lines(one_set()).size(), 2U);  // head and one method that was run
}

TEST(BenchReport, UnknownNamesAreRefused) {
  BenchOptions options;
  options.sets = {"virtuel"};
  EXPECT_THROW(options.validate(), UsageError);
  options.sets = {"virtual"};
  options.methods = {"defualt"};
  EXPECT_THROW(options.validate(), UsageError);
  options.methods = {"default"};
  EXPECT_NO_THROW(options.validate());
}

TEST(BenchReport, ASetWithoutItsDataIsLeftOutWithTheReason) {
  BenchOptions options;
  options.sets = {"ict", "meshmonk", "real"};
  const auto results = run_bench(options, Progress::none(), [](const CaseRow&) { FAIL(); });
  ASSERT_EQ(results.size(), 3U);
  for (const SetResult& result : results) EXPECT_NE(result.missing.find("VULTUS_DATA"), std::string::npos);
}

}  // namespace
}  // namespace vultus::apps::bench
