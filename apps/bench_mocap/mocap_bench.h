#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/progress.h"

namespace vultus::apps::bench_mocap {

struct MocapBenchOptions {
  std::vector<std::string> parts;  ///< empty: all
  std::filesystem::path data;      ///< unpacked real data; empty: parts that need it are left out
  int trials = 200;                ///< gaps of each cell, ≥ 20
  std::uint64_t seed = 1;
  void validate() const;  ///< throws `UsageError` for unknown parts and trials out of range
};

/// What the bench measures; a figure that was not measured is null in the JSON.
struct MocapFigures {
  nlohmann::json report;           ///< as `empty_report` lays it out
  nlohmann::json details;          ///< anything further, by part
  std::vector<std::string> lines;  ///< for people
  std::vector<std::string> left_out;
};

/// All keys of the report, null where they hold figures: labels_correct, labels_correct_in_swaps, swaps_left,
/// stabilization_rms_mm, gaps.{0.1,0.5,1,2}.{mean_mm,interpolation_mm,ratio,coverage},
/// gaps_by_count.{1,3,6}.{0.1,…}.{…}, coverage, read_seconds, clean_seconds.
nlohmann::json empty_report();

/// One part of the bench: fills its own keys of `figures.report`, adds lines, or says in `left_out` what is missing.
struct Part {
  std::string name;
  std::function<void(const MocapBenchOptions&, MocapFigures&, Progress&)> measure;
};

/// Gaps cut into real takes, filled, and compared with the truth and with interpolation.
void measure_gaps(const MocapBenchOptions& options, MocapFigures& figures, Progress& progress);

/// Reading and cleaning of ten minutes: seconds and memory (speed.h).
void measure_speed(const MocapBenchOptions& options, MocapFigures& figures, Progress& progress);

/// Labels repaired and head motion left on stage takes with swaps, phantoms, fragments, a slipping jig marker, noise
/// and missing samples.
void measure_labels_and_head(const MocapBenchOptions& options, MocapFigures& figures, Progress& progress);

/// Every part, in the order in which they run.
const std::vector<Part>& parts();

MocapFigures run_bench(const MocapBenchOptions& options, Progress& progress);

}  // namespace vultus::apps::bench_mocap
