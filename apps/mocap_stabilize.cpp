#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/mocap_files.h"
#include "mocap/stabilize.h"

namespace vultus::apps {
namespace {

struct Arguments {
  TakeArguments files;
  mocap::StabilizeOptions options;
};

const std::vector<std::pair<std::string, mocap::HeadMethod>> kMethods = {
    {"automatic", mocap::HeadMethod::automatic},
    {"jig", mocap::HeadMethod::jig},
    {"steady-face", mocap::HeadMethod::steady_face},
    {"three-point", mocap::HeadMethod::three_point}};

ExitCode stabilize(const Arguments& arguments, Run& run) {
  const mocap::Stabilized head = mocap::stabilize(read_step(arguments.files, run), arguments.options);
  for (const std::string& line : head.decisions) run.progress().note(line);
  nlohmann::json residuals = nlohmann::json::array();
  for (const mocap::HeadPose& pose : head.poses) {
    const bool measured = pose.kind == mocap::HeadPose::Kind::measured;
    residuals.push_back(measured ? nlohmann::json(pose.rms) : nlohmann::json(nullptr));
  }
  run.report()["head_markers"] = head.body.labels;
  run.report()["residuals_mm"] = residuals;
  run.numbers() = {{"head_rms_mm", head.rms}, {"reference_frame", head.reference_frame}};
  write_step(arguments.files, head.take, run);
  return ExitCode::ok;
}

}  // namespace

void add_mocap_stabilize(CommandTable& table) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App& app = table.add("mocap stabilize", "The head's motion taken out of a take",
                            "vultus mocap stabilize raw.c3d --out head.c3d --json residuals.json\n"
                            "  vultus mocap stabilize raw.c3d --jig H1 H2 H3 --method three-point --out head.c3d",
                            {}, [arguments](Run& run) { return stabilize(*arguments, run); });
  add_take_options(app, arguments->files);
  add_choice(app, "--method", arguments->options.method,
             "automatic: the jig where there is one, else the steadiest markers of the face; three-point: as Zhu 2006",
             kMethods);
  app.add_option("--jig", arguments->options.jig, "Labels of the head's markers (default: those that look like it)")
      ->type_name("LABEL…");
  app.add_option("--nose-tip", arguments->options.nose_tip, "Take the translation from this marker (Zhu 2006 §6.1)")
      ->type_name("LABEL");
  app.add_option("--reference", arguments->options.reference_frame,
                 "Frame, from 0, whose head coordinates are used (default: the most central complete one)")
      ->type_name("FRAME")
      ->check(CLI::NonNegativeNumber);
}

}  // namespace vultus::apps
