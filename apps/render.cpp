#include <CLI/CLI.hpp>
#include <tuple>

#include "apps/commands.h"
#include "apps/frame_range.h"
#include "apps/take_rendering.h"

namespace vultus::apps {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  RenderRequest request;
  std::string size = "512x512";
  double azimuth = 0.0, elevation = 0.0, light_rotation = 0.0;  // degrees
};

ExitCode render(const Arguments& arguments, Run& run) {
  constexpr double radians = 3.14159265358979323846 / 180.0;
  RenderRequest request = arguments.request;
  render::SequenceOptions& options = request.options;
  std::tie(options.portrait.width, options.portrait.height) = picture_size(arguments.size);
  options.portrait.azimuth = arguments.azimuth * radians;
  options.portrait.elevation = arguments.elevation * radians;
  options.environment_rotation = arguments.light_rotation * radians;
  options.tracer.seed = run.seed();
  options.force = run.force();
  const render::SequenceResult result = render_take(request, run.progress());
  run.numbers() = {{"frames", result.frames.size()}, {"rendered", result.rendered}, {"rays", result.rays}};
  for (const fs::path& frame : result.frames) run.print(frame.string());
  return ExitCode::ok;
}

}  // namespace

void add_render(CommandTable& table) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App& app = table.add("render", "Path-traced frames of a session's take: EXR with layers, and PNG",
                            "vultus render session --take smile --frames 0:24 --size 512x512 --spp 64 --film smile.mp4",
                            {.seed = true, .force = true}, [arguments](Run& run) { return render(*arguments, run); });
  RenderRequest& request = arguments->request;
  render::SequenceOptions& options = request.options;
  app.add_option("SESSION", request.session, "Session folder, as `vultus session` writes it")->required();
  app.add_option("--take", request.take, "Take to render")->required()->type_name("TAKE");
  app.add_option("--frames", request.frames, "Frames A up to but not including B, from 0 (default: all)")
      ->type_name("A:B");
  app.add_option("--count", request.count, "At most so many frames, spread evenly over the range (0: all)")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--size", arguments->size, "Size of the pictures, pixels")->type_name("WxH")->capture_default_str();
  app.add_option("--spp", options.tracer.samples, "Samples a pixel")
      ->check(CLI::Range(1, 65536))
      ->capture_default_str();
  app.add_option("--noise", options.tracer.noise_target, "Stop a tile early below this relative noise (0: never)")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--azimuth", arguments->azimuth, "Camera's turn towards the subject's left, degrees")
      ->capture_default_str();
  app.add_option("--elevation", arguments->elevation, "Camera's height above the face, degrees")->capture_default_str();
  app.add_option("--light", options.environment,
                 "Latitude-longitude HDR that lights the head (default: a portrait studio)")
      ->type_name("FILE");
  app.add_option("--light-rotation", arguments->light_rotation, "Turn of the light about the head, degrees")
      ->capture_default_str();
  app.add_option("--exposure", options.exposure, "Stops, of the PNG")->capture_default_str();
  app.add_flag("--show-light", options.show_environment, "Show the light's picture behind the head");
  app.add_option("--film", request.film, "Also make a film of the frames (needs ffmpeg)")->type_name("FILE.mp4");
}

}  // namespace vultus::apps
