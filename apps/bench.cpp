#include <CLI/CLI.hpp>
#include <cstdlib>
#include <iostream>

#include "apps/bench_mocap/mocap_bench.h"
#include "apps/bench_registration/bench_report.h"
#include "apps/commands.h"
#include "register/register_options.h"

namespace vultus::apps {
namespace {

bench::BenchOptions prepared(bench::BenchOptions options, std::uint64_t seed) {
  options.set.seed = seed;
  if (const char* data = std::getenv("VULTUS_DATA"); options.set.data.empty() && data) options.set.data = data;
  options.validate();
  return options;
}

ExitCode bench_registration(const bench::BenchOptions& given, Run& run) {
  const bench::BenchOptions options = prepared(given, run.seed());
  const std::vector<bench::SetResult> results =
      bench::run_bench(options, run.progress(), [&](const bench::CaseRow& row) {
        run.print(bench::row_line(row));
        std::cout.flush();
      });
  for (const bench::SetResult& result : results)
    if (!result.missing.empty()) run.warn("set " + result.name + " left out: " + result.missing);
  for (const std::string& line : bench::table_lines(results)) run.print(line);
  run.report()["sets"] = bench::sets_json(results);
  run.numbers()["cases"] = bench::cases_json(results);
  return ExitCode::ok;
}

ExitCode run_mocap_bench(const bench_mocap::MocapBenchOptions& given, Run& run) {
  bench_mocap::MocapBenchOptions options = given;
  options.seed = run.seed();
  if (const char* data = std::getenv("VULTUS_DATA"); options.data.empty() && data) options.data = data;
  options.validate();
  const bench_mocap::MocapFigures figures = bench_mocap::run_bench(options, run.progress());
  for (const std::string& line : figures.left_out) run.warn("left out: " + line);
  for (const std::string& line : figures.lines) run.print(line);
  run.report().update(figures.report);
  run.numbers() = figures.details;
  return ExitCode::ok;
}

}  // namespace

void add_bench_registration(CommandTable& table) {
  auto options = std::make_shared<bench::BenchOptions>();
  CLI::App& app = table.add("bench registration", "How far registered scans are from the truth, method beside method",
                            "vultus bench registration --set ict --method default --people 1 --pose jawOpen\n"
                            "  vultus bench registration --json figures.json",
                            {.seed = true}, [options](Run& run) { return bench_registration(*options, run); });
  app.add_option("--set", options->sets, "virtual, ict, meshmonk, real or large; may be given again")
      ->capture_default_str();
  app.add_option("--method", options->methods, "default, zhu, …; may be given again (default: all)");
  app.add_option("--people", options->set.people, "At most so many of each set (0: all)")->check(CLI::Range(0, 1000));
  app.add_option("--pose", options->poses, "May be given again (default: all); the neutral always comes");
  app.add_option("--triangles", options->set.triangles, "Of a test scan (0: the set's own density)")
      ->check(CLI::Range(0, 10'000'000));
  app.add_option("--data", options->set.data, "Unpacked real data (default: $VULTUS_DATA)")->type_name("FOLDER");
  app.add_option("--pictures", options->pictures, "Heat maps of the distance to the true vertex go here")
      ->type_name("FOLDER");
  app.add_option("--scans", options->scans, "The test scans and their true vertices go here, as PLY")
      ->type_name("FOLDER");
}

void add_bench_mocap(CommandTable& table) {
  auto options = std::make_shared<bench_mocap::MocapBenchOptions>();
  CLI::App& app = table.add("bench mocap", "How well takes are cleaned: labels, head, gaps, speed",
                            "vultus bench mocap --part gaps --json figures.json", {.seed = true},
                            [options](Run& run) { return run_mocap_bench(*options, run); });
  app.add_option("--part", options->parts, "One of the bench's parts; may be given again (default: all)");
  app.add_option("--trials", options->trials, "Gaps of each length and number of markers")->capture_default_str();
  app.add_option("--data", options->data, "Unpacked real data (default: $VULTUS_DATA)")->type_name("FOLDER");
}

}  // namespace vultus::apps
