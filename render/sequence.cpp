#include "render/sequence.h"

#include <fmt/format.h>

#include "core/error.h"
#include "render/face_look.h"
#include "retarget/face.h"

namespace vultus::render {
namespace {

/// Forwards cancellation of a frame's tracing, while the sequence counts frames.
class WithinFrame final : public Progress {
 public:
  explicit WithinFrame(const Progress& outer) : outer_(outer) {}
  void begin(std::string_view, std::size_t) override {}
  void advance(std::size_t) override {}
  void note(std::string_view) override {}
  bool cancelled() const override { return outer_.cancelled(); }

 private:
  const Progress& outer_;
};

Provenance frame_provenance(const Provenance& source, const SequenceOptions& o, int frame) {
  Provenance result = source;
  result.options["frame"] = frame;
  result.options["size"] = {o.portrait.width, o.portrait.height};
  result.options["view"] = {o.portrait.azimuth, o.portrait.elevation, o.portrait.margin};
  result.options["tracer"] = {{"samples", o.tracer.samples},
                              {"noise_target", o.tracer.noise_target},
                              {"bounces", o.tracer.bounces},
                              {"seed", o.tracer.seed},
                              {"clamp", o.tracer.clamp}};
  result.options["light"] = {
      {"rotation", o.environment_rotation}, {"intensity", o.environment_intensity}, {"shown", o.show_environment}};
  result.options["picture"] = {{"curve", o.curve == ToneCurve::filmic ? "filmic" : "srgb"}, {"exposure", o.exposure}};
  if (!o.environment.empty()) result.inputs["environment"] = sha256_of_file(o.environment);
  return result;
}

struct FrameRange {
  int first, last;
};

FrameRange range_of(const SequenceOptions& options, int frames) {
  const int last = options.last < 0 ? frames : options.last;
  if (options.first < 0 || options.first >= last || last > frames)
    throw UsageError(fmt::format("frames {}:{} are not in the take, which has 0:{}", options.first, last, frames));
  if (options.step < 1) throw UsageError("the step between frames must be at least 1");
  return {options.first, last};
}

}  // namespace

Scene actor_scene(const rig::Actor& actor, const SequenceOptions& options) {
  Scene scene;
  scene.topology = actor.topology;
  scene.positions = actor.neutral();
  FaceLook look = face_look(*actor.topology, actor.neutral());
  if (actor.albedo.empty())
    scene.vertex_colours = std::move(look.colours);
  else
    scene.albedo = actor.albedo;
  scene.finishes = std::move(look.finishes);
  scene.hidden_vertices = std::move(look.hidden_vertices);
  const double rotation = options.environment_rotation, intensity = options.environment_intensity;
  scene.environment = std::make_shared<Environment>(options.environment.empty()
                                                        ? Environment::studio(rotation, intensity)
                                                        : Environment::load(options.environment, rotation, intensity));
  if (!options.show_environment) scene.backdrop = Eigen::Vector3f(0.045f, 0.048f, 0.055f);
  scene.camera = portrait_camera(*actor.topology, actor.neutral(), options.portrait);
  return scene;
}

SequenceResult render_sequence(const rig::Actor& actor, const retarget::Weights& weights,
                               const std::filesystem::path& folder, const Provenance& source,
                               const SequenceOptions& options, Progress& progress) {
  options.tracer.validate();
  const FrameRange range = range_of(options, weights.frames());
  const retarget::Face face(actor, weights.poses, weights.regions);
  Scene scene = actor_scene(actor, options);
  WithinFrame within(progress);
  SequenceResult result;
  progress.begin("rendering frames", static_cast<std::size_t>((range.last - range.first - 1) / options.step + 1));
  for (int frame = range.first; frame < range.last; frame += options.step) {
    progress.check();
    const std::string name = fmt::format("{:06}", frame);
    const std::string exr = name + ".exr", png = name + ".png";
    Manifest manifest = Manifest::open(folder / (name + ".json"), "frame");
    const Provenance provenance = frame_provenance(source, options, frame);
    result.frames.push_back(folder / exr);
    if (options.force || !manifest.is_current(exr, provenance) || !manifest.is_current(png, provenance)) {
      scene.positions = face.at(weights, frame);
      const PathTracerResult traced = trace_paths(scene, options.tracer, within);
      write_frame(folder / exr, traced.layers, options.curve, options.exposure);
      manifest.record(exr, provenance);
      manifest.record(png, provenance);
      manifest.save();
      result.rays += traced.rays;
      ++result.rendered;
    }
    progress.advance();
  }
  return result;
}

}  // namespace vultus::render
