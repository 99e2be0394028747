#include <cstdio>

#include "apps/bench_mocap/gap_cells.h"
#include "apps/bench_mocap/mocap_bench.h"
#include "mocap/stabilize.h"

namespace vultus::apps::bench_mocap {

namespace {

namespace fs = std::filesystem;

nlohmann::json cell_json(const GapCell& cell) {
  return {{"mean_mm", cell.mean()},
          {"interpolation_mm", cell.interpolation / cell.samples},
          {"ratio", cell.ratio()},
          {"coverage", cell.coverage()}};
}

std::string cell_line(const GapCell& cell) {
  char text[160];
  std::snprintf(text, sizeof text,
                "gaps %3g s %-9s %4d trials  %.3f mm, %.2f of interpolation's %.3f, coverage %.2f, holes %.1f %%",
                cell.seconds, cell.count > 0 ? ("x " + std::to_string(cell.count)).c_str() : "pooled", cell.trials,
                cell.mean(), cell.ratio(), cell.interpolation / cell.samples, cell.coverage(),
                100.0 * cell.holes / (cell.holes + cell.samples));
  return text;
}

std::vector<mocap::Take> steady_takes(const fs::path& folder) {
  std::vector<mocap::Take> takes;
  for (const char* name : {"Jaw.c3d", "Eyebrows.c3d"}) {
    takes.push_back(mocap::stabilize(mocap::read_take(folder / name)).take);
  }
  return takes;
}

}  // namespace

void measure_gaps(const MocapBenchOptions& options, MocapFigures& figures, Progress& progress) {
  const fs::path folder = options.data / "animface-markers";
  if (options.data.empty() || !fs::is_directory(folder)) {
    figures.left_out.push_back("gaps: no folder animface-markers in the data");
    return;
  }
  const std::vector<mocap::Take> takes = steady_takes(folder);
  progress.begin("gaps", kGapSeconds.size() * kGapCounts.size());
  GapCell all;
  for (const double seconds : kGapSeconds) {
    GapCell pooled;
    pooled.seconds = seconds;
    for (const int count : kGapCounts) {
      const GapCell cell = measure_cell(takes, seconds, count, options.trials, options.seed, progress);
      progress.advance();
      figures.report["gaps_by_count"][std::to_string(count)][gap_key(seconds)] = cell_json(cell);
      figures.lines.push_back(cell_line(cell));
      progress.note(figures.lines.back());
      pooled += cell;
    }
    figures.report["gaps"][gap_key(seconds)] = cell_json(pooled);
    figures.lines.push_back(cell_line(pooled));
    all += pooled;
  }
  figures.report["coverage"] = all.coverage();
}

}  // namespace vultus::apps::bench_mocap
