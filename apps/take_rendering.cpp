#include "apps/take_rendering.h"

#include <tuple>

#include "apps/command.h"
#include "apps/film.h"
#include "apps/frame_range.h"
#include "apps/session_actor.h"
#include "apps/session_takes.h"
#include "core/manifest.h"
#include "retarget/weights.h"

namespace vultus::apps {
namespace {

namespace fs = std::filesystem;

Manifest open_session(const RenderRequest& request) {
  const fs::path file = request.session / "session.json";
  if (!fs::exists(file)) {
    throw InputError(request.session, "is no session folder: it has no session.json; `vultus session` makes one");
  }
  Manifest session = Manifest::open(file, "session");
  check_name("take", request.take, session.facts().value("takes", std::vector<std::string>()));
  for (const char* artefact : {"weights.npy", "weights.json"}) session.verify(take_artefact(request.take, artefact));
  return session;
}

Provenance source_of(const RenderRequest& request, const Manifest& session) {
  Provenance source{"render", nlohmann::json::object(), {}};
  source.inputs["actor"] = sha256_of_file(actor_folder(session) / "actor.json");
  source.inputs["weights"] = session.hash(take_artefact(request.take, "weights.npy"));
  if (session.has("regions/vertex_masks.npy")) source.inputs["regions"] = session.hash("regions/vertex_masks.npy");
  return source;
}

}  // namespace

render::SequenceResult render_take(const RenderRequest& request, Progress& progress) {
  const Manifest session = open_session(request);
  const retarget::Weights weights =
      retarget::read_weights(request.session / take_artefact(request.take, "weights.npy"));
  render::SequenceOptions options = request.options;
  std::tie(options.first, options.last) = frame_range(request.frames, weights.frames());
  const int frames = options.last - options.first;
  options.step = request.count > 0 ? std::max(1, (frames + request.count - 1) / request.count) : 1;

  const rig::Actor actor = load_session_actor(session);
  const fs::path folder = request.session / "render" / request.take / "reference";
  const render::SequenceResult result =
      render::render_sequence(actor, weights, folder, source_of(request, session), options, progress);
  if (!request.film.empty()) {
    std::vector<fs::path> pictures = result.frames;
    for (fs::path& picture : pictures) picture.replace_extension(".png");
    progress.begin("film", 0);
    write_film(request.film, pictures, weights.rate_hz / options.step);
  }
  return result;
}

}  // namespace vultus::apps
