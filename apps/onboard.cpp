#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/onboarding.h"
#include "register/register_options.h"

namespace vultus::apps {
namespace {

ExitCode onboard(OnboardOptions options, Run& run) {
  options.seed = run.seed();
  options.force = run.force();
  const OnboardResult result = onboard_actor(options, run.progress());
  for (const std::string& line : result.warnings) run.warn(line);
  for (const std::string& line : result.failed) run.warn("left out: " + line);
  run.numbers() = {{"registered", result.registered},
                   {"transferred", result.transferred},
                   {"reused", result.reused},
                   {"failed", result.failed.size()},
                   {"registration", result.report}};
  run.print(options.actor.string());
  if (!result.failed.empty()) return ExitCode::bad_input;
  return result.below_quality ? ExitCode::below_quality : ExitCode::ok;
}

}  // namespace

void add_onboard(CommandTable& table) {
  auto options = std::make_shared<OnboardOptions>();
  CLI::App& app = table.add("onboard", "Raw scans of an actor to a database of poses in one topology",
                            "vultus onboard capture --actor actor\n"
                            "  vultus onboard capture --actor actor --databank databank   (one neutral scan is enough)",
                            {.seed = true, .force = true}, [options](Run& run) { return onboard(*options, run); });
  app.add_option("CAPTURE", options->capture, "Folder with scans/<pose>.{obj,ply,stl}, one of them the neutral")
      ->required();
  app.add_option("--actor", options->actor, "Actor folder to write")->required()->type_name("FOLDER");
  app.add_option(
         "--template", options->template_path,
         "template.obj with template.json beside it, or their folder (default: the databank's, else the built-in head)")
      ->type_name("PATH");
  app.add_option("--databank", options->databank,
                 "Actor folder whose expressions fill in for poses that were not scanned")
      ->type_name("FOLDER");
  app.add_option("--poses", options->poses, "Only these poses (and the neutral)")
      ->type_name("POSE…")
      ->expected(1, 1000);
  add_choice(app, "--landmarks-by", options->landmarks_by, "What finds the points that are not placed by hand",
             registration::landmark_finder_names());
  add_choice(app, "--method", options->method, "How scans are brought to the template", registration::method_names());
  add_choice(app, "--energy-solver", options->energy_solver, "What minimizes the energy of --method sanchez",
             registration::energy_solver_names());
  add_choice(app, "--transfer", options->transfer, "How motion comes from the databank", {"gradient", "zhu"});
  app.add_option("--memory", options->memory_gb,
                 "Gigabytes that scans side by side may take (0: four fifths of what is available)")
      ->check(CLI::Range(0.0, 1e5))
      ->type_name("GB");
  app.add_option("--regions", options->regions, "Regions the face is divided into")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
}

}  // namespace vultus::apps
