#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/onboarding.h"
#include "apps/review_page.h"
#include "apps/session_pipeline.h"
#include "apps/simulated_capture.h"
#include "apps/take_rendering.h"

namespace vultus::apps {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  fs::path folder;
  int frames = 12, size = 384, samples = 48;
};

OnboardResult onboard(const Arguments& arguments, Run& run) {
  OnboardOptions options;
  options.capture = arguments.folder / "capture";
  options.actor = arguments.folder / "actor";
  options.seed = run.seed();
  options.force = run.force();
  OnboardResult result = onboard_actor(options, run.progress());
  for (const std::string& line : result.warnings) run.warn(line);
  for (const std::string& line : result.failed) run.warn("left out: " + line);
  return result;
}

SessionResult retarget_takes(const Arguments& arguments, const std::vector<fs::path>& takes, Run& run) {
  SessionOptions options;
  options.takes = takes;
  options.training = takes.front().parent_path() / "training.c3d";
  options.actor = arguments.folder / "actor";
  options.session = arguments.folder / "session";
  options.seed = run.seed();
  options.force = run.force();
  SessionResult result = run_session(options, run.progress());
  for (const std::string& line : result.warnings) run.warn(line);
  return result;
}

int render_frames(const Arguments& arguments, const std::string& take, Run& run) {
  RenderRequest request;
  request.session = arguments.folder / "session";
  request.take = take;
  request.count = arguments.frames;
  request.options.portrait.width = request.options.portrait.height = arguments.size;
  request.options.tracer.samples = arguments.samples;
  request.options.tracer.seed = run.seed();
  request.options.force = run.force();
  return render_take(request, run.progress()).rendered;
}

ExitCode demo(const Arguments& arguments, Run& run) {
  virtual_stage::StageOptions stage;
  stage.seed = run.seed();
  simulate_once(arguments.folder, stage, run.force(), run.progress());
  const OnboardResult actor = onboard(arguments, run);
  const std::vector<fs::path> takes = simulated_takes(arguments.folder, stage);
  const SessionResult session = retarget_takes(arguments, takes, run);
  int rendered = 0;
  for (const fs::path& take : takes) rendered += render_frames(arguments, take.stem().string(), run);
  const ReviewPage page = write_review(arguments.folder / "session", {}, run.progress());
  run.numbers() = {
      {"registration", actor.report}, {"errors", session.tables}, {"rendered", rendered}, {"findings", page.findings}};
  run.print(page.file.string());
  return actor.failed.empty() && !actor.below_quality ? ExitCode::ok : ExitCode::below_quality;
}

}  // namespace

void add_demo(CommandTable& table) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App& app =
      table.add("demo", "Everything on synthetic actors, from raw scans to a review page", "vultus demo demo-out",
                {.seed = true, .force = true}, [arguments](Run& run) { return demo(*arguments, run); });
  app.add_option("DIR", arguments->folder, "Folder to write; the page is DIR/session/review/index.html")->required();
  app.add_option("--frames", arguments->frames, "Frames rendered of each performance, spread over it")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  app.add_option("--size", arguments->size, "Width and height of the frames, pixels")
      ->check(CLI::Range(16, 8192))
      ->capture_default_str();
  app.add_option("--spp", arguments->samples, "Samples a pixel")->check(CLI::Range(1, 65536))->capture_default_str();
}

}  // namespace vultus::apps
