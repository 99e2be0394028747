#include "apps/bench_mocap/mocap_bench.h"

#include <algorithm>

#include "apps/bench_mocap/gap_cells.h"
#include "apps/command.h"
#include "core/error.h"

namespace vultus::apps::bench_mocap {

namespace {

std::vector<std::string> part_names() {
  std::vector<std::string> names;
  for (const Part& part : parts()) names.push_back(part.name);
  return names;
}

}  // namespace

void MocapBenchOptions::validate() const {
  for (const std::string& part : parts) check_name("part", part, part_names());
  if (trials < 20) throw UsageError("trials must be 20 or more");
}

nlohmann::json empty_report() {
  nlohmann::json report;
  for (const char* key : {"labels_correct", "labels_correct_in_swaps", "swaps_left", "stabilization_rms_mm", "coverage",
                          "read_seconds", "clean_seconds"}) {
    report[key] = nullptr;
  }
  const nlohmann::json cell = {
      {"mean_mm", nullptr}, {"interpolation_mm", nullptr}, {"ratio", nullptr}, {"coverage", nullptr}};
  for (const double seconds : kGapSeconds) {
    report["gaps"][gap_key(seconds)] = cell;
    for (const int count : kGapCounts) report["gaps_by_count"][std::to_string(count)][gap_key(seconds)] = cell;
  }
  return report;
}

const std::vector<Part>& parts() {
  static const std::vector<Part> all = {
      {"labels", measure_labels_and_head}, {"gaps", measure_gaps}, {"speed", measure_speed}};
  return all;
}

MocapFigures run_bench(const MocapBenchOptions& options, Progress& progress) {
  MocapFigures figures{empty_report(), nlohmann::json::object(), {}, {}};
  for (const Part& part : parts()) {
    const bool wanted = options.parts.empty() ||
                        std::find(options.parts.begin(), options.parts.end(), part.name) != options.parts.end();
    if (wanted) part.measure(options, figures, progress);
  }
  return figures;
}

}  // namespace vultus::apps::bench_mocap
