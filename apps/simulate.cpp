#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/simulated_capture.h"
#include "apps/virtual_stage/expressions.h"
#include "apps/virtual_stage/performances.h"

namespace vultus::apps {
namespace {

struct Arguments {
  std::filesystem::path folder;
  virtual_stage::StageOptions options;
  bool no_clutter = false, no_mocap = false;
};

ExitCode simulate(const Arguments& arguments, Run& run) {
  virtual_stage::StageOptions options = arguments.options;
  options.seed = run.seed();
  options.clutter = !arguments.no_clutter;
  options.mocap = !arguments.no_mocap;
  std::vector<std::string> poses;
  for (const virtual_stage::Expression& expression : virtual_stage::expression_database())
    poses.push_back(expression.name);
  for (const std::string& pose : options.poses) check_name("pose", pose, poses);
  for (const std::string& name : options.performances) {
    check_name("performance", name, virtual_stage::performance_names());
  }
  if (!simulate_once(arguments.folder, options, run.force(), run.progress()))
    run.progress().note("nothing has changed");
  run.print((arguments.folder / "capture").string());
  return ExitCode::ok;
}

}  // namespace

void add_simulate(CommandTable& table) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App& app =
      table.add("simulate", "What a studio would bring: raw scans and marker takes of synthetic actors, with the truth",
                "vultus simulate studio --seed 7\n  vultus onboard studio/capture --actor actor",
                {.seed = true, .force = true}, [arguments](Run& run) { return simulate(*arguments, run); });
  virtual_stage::StageOptions& options = arguments->options;
  app.add_option("DIR", arguments->folder, "Folder to write: capture/ and truth/")->required();
  app.add_option("--poses", options.poses, "Only these poses (and the neutral)")->type_name("POSE…")->expected(1, 1000);
  app.add_option("--triangles", options.scan_triangles, "Of each scan")
      ->check(CLI::Range(1000, 10'000'000))
      ->capture_default_str();
  app.add_option("--scan-noise", options.scan_noise, "Along the scanner's rays, mm")
      ->check(CLI::Range(0.0, 5.0))
      ->capture_default_str();
  app.add_flag("--no-clutter", arguments->no_clutter, "No hair, shoulders, stand or flying points in the scans");
  app.add_flag("--landmarks", options.landmarks, "Also landmarks as a person would place them");
  app.add_option("--performances", options.performances, "Only these performances")
      ->type_name("NAME…")
      ->expected(1, 1000);
  app.add_option("--seconds", options.performance_seconds, "Of each performance")
      ->check(CLI::Range(1.0, 600.0))
      ->capture_default_str();
  app.add_option("--marker-noise", options.marker_noise, "Each coordinate, mm")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  app.add_option("--marker-missing", options.marker_missing, "Share of the samples that cameras lose")
      ->check(CLI::Range(0.0, 0.5))
      ->capture_default_str();
  app.add_option(
         "--faults", options.faults,
         "Swaps, phantoms, fragments without a label, spikes, dropouts to zero, held frames and a slip of the "
         "jig in every take, times as many as a tracker usually leaves; truth/mocap/TAKE/faults.json says where")
      ->type_name("TIMES")
      ->check(CLI::Range(0.0, 20.0))
      ->capture_default_str();
  app.add_flag("--no-mocap", arguments->no_mocap, "Scans only");
}

}  // namespace vultus::apps
