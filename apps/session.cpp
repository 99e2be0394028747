#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/session_pipeline.h"

namespace vultus::apps {
namespace {

void print_table(const nlohmann::json& tables, Run& run) {
  run.print("take,solve,max_mm,min_mm,mean_mm");
  for (const auto& [take, rows] : tables.items()) {
    for (const auto& row : rows) {
      run.print_row({take, row.at("name"), row.at("max_mm"), row.at("min_mm"), row.at("mean_mm")});
    }
  }
}

ExitCode session(SessionOptions options, Run& run) {
  options.seed = run.seed();
  options.force = run.force();
  for (const auto& take : options.takes) run.input(take);
  const SessionResult result = run_session(options, run.progress());
  for (const std::string& line : result.warnings) run.warn(line);
  run.numbers() = {{"takes", result.takes}, {"reused", result.reused}, {"errors", result.tables}};
  print_table(result.tables, run);
  return ExitCode::ok;
}

}  // namespace

void add_session(CommandTable& table) {
  auto options = std::make_shared<SessionOptions>();
  CLI::App& app = table.add(
      "session", "Raw marker takes to a moving face: cleaned takes, weights, errors",
      "vultus session takes/smile.c3d takes/talk.c3d --actor actor --session session --training takes/training.c3d\n"
      "  vultus session Jaw.c3d --actor actor --session session --markers anchors.json",
      {.seed = true, .force = true}, [options](Run& run) { return session(*options, run); });
  app.add_option("TAKE", options->takes, "C3D, TRC or CSV files")->required()->type_name("FILE…");
  app.add_option("--actor", options->actor, "Actor folder, as `vultus onboard` writes it")
      ->required()
      ->type_name("FOLDER");
  app.add_option("--session", options->session, "Session folder to write")->required()->type_name("FOLDER");
  app.add_option(
         "--training", options->training,
         "Take in which the mocap actor shows the database's poses (with training.json beside it, else they are found)")
      ->type_name("FILE");
  app.add_option(
         "--markers", options->markers,
         "JSON that says where markers sit on the actor (default: markers.json beside the takes, else the actor's own)")
      ->type_name("FILE");
  app.add_option("--neutral", options->neutral_frame,
                 "Frame of the first take that shows the neutral, from 0 (without a training take; default: found)")
      ->type_name("FRAME")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--regions", options->regions, "Divide the face into so many regions (default: the actor's own)")
      ->check(CLI::Range(1, 64));
  app.add_flag("--keep-labels", options->keep_labels,
               "Swaps, fragments and phantoms are left as they are (default: repaired, listed in labels.json)");
  add_choice(app, "--solver", options->solver, "qp: weights for each region; global: one set for the face",
             {"qp", "global"});
  app.add_option("--smoothing", options->smoothing, "Gaussian over time on the weights, deviation in seconds (0: none)")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
}

}  // namespace vultus::apps
