#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/film.h"
#include "apps/frame_range.h"
#include "apps/session_actor.h"
#include "apps/session_takes.h"
#include "core/manifest.h"
#include "render/sequence.h"
#include "retarget/weights.h"

namespace vultus::apps {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  fs::path session, film;
  std::string take, frames, size = "512x512";
  double azimuth = 0.0, elevation = 0.0;  // degrees
  render::SequenceOptions options;
};

constexpr double radians = 3.14159265358979323846 / 180.0;

render::SequenceOptions sequence_options(const Arguments& arguments, const Run& run, int frames) {
  render::SequenceOptions options = arguments.options;
  std::tie(options.first, options.last) = frame_range(arguments.frames, frames);
  std::tie(options.portrait.width, options.portrait.height) = picture_size(arguments.size);
  options.portrait.azimuth = arguments.azimuth * radians;
  options.portrait.elevation = arguments.elevation * radians;
  options.environment_rotation *= radians;
  options.tracer.seed = run.seed();
  options.force = run.force();
  return options;
}

std::vector<std::string> take_names(const Manifest& session) {
  return session.facts().value("takes", std::vector<std::string>());
}

ExitCode render_take(const Arguments& arguments, Run& run) {
  if (!fs::exists(arguments.session / "session.json")) {
    throw InputError(arguments.session, "is no session folder: it has no session.json; `vultus session` makes one");
  }
  const Manifest session = Manifest::open(arguments.session / "session.json", "session");
  check_name("take", arguments.take, take_names(session));
  for (const char* file : {"weights.npy", "weights.json"}) session.verify(take_artefact(arguments.take, file));
  const retarget::Weights weights =
      retarget::read_weights(arguments.session / take_artefact(arguments.take, "weights.npy"));
  const render::SequenceOptions options = sequence_options(arguments, run, weights.frames());
  const rig::Actor actor = load_session_actor(session);

  Provenance source{"render", nlohmann::json::object(), {}};
  source.inputs["actor"] = sha256_of_file(actor_folder(session) / "actor.json");
  source.inputs["weights"] = session.hash(take_artefact(arguments.take, "weights.npy"));
  if (session.has("regions/vertex_masks.npy")) source.inputs["regions"] = session.hash("regions/vertex_masks.npy");
  const fs::path folder = arguments.session / "render" / arguments.take / "reference";
  const render::SequenceResult result =
      render::render_sequence(actor, weights, folder, source, options, run.progress());
  run.numbers() = {{"frames", result.frames.size()}, {"rendered", result.rendered}, {"rays", result.rays}};

  if (!arguments.film.empty()) {
    std::vector<fs::path> pictures = result.frames;
    for (fs::path& picture : pictures) picture.replace_extension(".png");
    write_film(arguments.film, pictures, weights.rate_hz);
  }
  for (const fs::path& frame : result.frames) run.print(frame.string());
  return ExitCode::ok;
}

}  // namespace

void add_render(CommandTable& table) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App& app =
      table.add("render", "Path-traced frames of a session's take: EXR with layers, and PNG",
                "vultus render session --take smile --frames 0:24 --size 512x512 --spp 64 --film smile.mp4",
                {.seed = true, .force = true}, [arguments](Run& run) { return render_take(*arguments, run); });
  render::SequenceOptions& options = arguments->options;
  app.add_option("SESSION", arguments->session, "Session folder, as `vultus session` writes it")->required();
  app.add_option("--take", arguments->take, "Take to render")->required()->type_name("TAKE");
  app.add_option("--frames", arguments->frames, "Frames A up to but not including B, from 0 (default: all)")
      ->type_name("A:B");
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
  app.add_option("--light-rotation", options.environment_rotation, "Turn of the light about the head, degrees")
      ->capture_default_str();
  app.add_option("--exposure", options.exposure, "Stops, of the PNG")->capture_default_str();
  app.add_flag("--show-light", options.show_environment, "Show the light's picture behind the head");
  app.add_option("--film", arguments->film, "Also make a film of the frames (needs ffmpeg)")->type_name("FILE.mp4");
}

}  // namespace vultus::apps
