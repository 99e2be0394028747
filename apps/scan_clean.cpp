#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/scan_file.h"
#include "core/mesh_io.h"

namespace vultus::apps {
namespace {

struct Arguments {
  std::filesystem::path scan, out;
  scan::CleanOptions options;
};

ExitCode clean(const Arguments& arguments, Run& run) {
  run.input(arguments.scan);
  const scan::CleanScan cleaned = clean_scan_file(arguments.scan, arguments.options, run.progress());
  for (const std::string& line : cleaned.report.lines()) run.progress().note(line);
  write_ply(arguments.out, cleaned.mesh);
  run.numbers() = {
      {"mm_per_unit", cleaned.report.units.mm_per_unit},   {"vertices_before", cleaned.report.vertices_before},
      {"vertices_after", cleaned.report.vertices_after},   {"triangles_before", cleaned.report.triangles_before},
      {"triangles_after", cleaned.report.triangles_after}, {"open_boundaries", cleaned.report.open_boundaries},
      {"holes_filled", cleaned.report.holes_filled},       {"invented_triangles", cleaned.report.invented_triangles}};
  run.print(arguments.out.string());
  return ExitCode::ok;
}

}  // namespace

void add_scan_clean(CommandTable& table) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App& app = table.add("scan clean", "Raw scan to clean geometry in millimetres",
                            "vultus scan clean raw.obj --out clean.ply --fill-holes 20", {},
                            [arguments](Run& run) { return clean(*arguments, run); });
  scan::CleanOptions& options = arguments->options;
  app.add_option("SCAN", arguments->scan, "OBJ, PLY or STL")->required()->type_name("FILE");
  app.add_option("--out", arguments->out, "PLY to write")->required()->type_name("FILE");
  app.add_option("--mm-per-unit", options.mm_per_unit, "Millimetres in one unit of the scan (0: from its size)");
  app.add_option("--smallest-component", options.smallest_component,
                 "Share of the largest component's area below which a component is stray")
      ->capture_default_str();
  app.add_option("--spike-factor", options.spike_factor, "How many usual steps off its neighbours makes a spike")
      ->capture_default_str();
  app.add_option("--wildness", options.wildness,
                 "Share of steep triangles around a vertex that makes it hair-like clutter (1: keep all)")
      ->capture_default_str();
  app.add_option("--fill-holes", options.largest_filled_hole, "Fill holes up to this boundary length, mm (0: none)")
      ->capture_default_str();
  app.add_option("--triangles", options.target_triangles, "Decimate to about so many (0: keep the density)")
      ->capture_default_str();
}

}  // namespace vultus::apps
