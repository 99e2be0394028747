#include "apps/session_actor.h"

#include "core/error.h"
#include "rig/database.h"
#include "rig/region_masks.h"

namespace vultus::apps {

namespace fs = std::filesystem;

rig::Actor session_actor(const fs::path& folder, int regions, std::uint64_t seed, Manifest& session) {
  rig::Actor actor = rig::load_actor(folder);
  if (regions == 0) {
    for (const std::string& artefact : session.artefacts()) {
      if (artefact.starts_with("regions/")) session.forget(artefact);
    }
    return actor;
  }
  const Provenance provenance{
      "session", {{"regions", regions}, {"seed", seed}}, {{"actor", sha256_of_file(folder / "actor.json")}}};
  if (!rig::regions_are_current(session, provenance)) {
    rig::divide_face(actor, {.regions = regions, .seed = seed});
    rig::write_regions(session, actor.topology->vertex_count(), actor.regions, actor.region_masks, provenance);
  }
  rig::read_regions(session, actor);
  return actor;
}

fs::path actor_folder(const Manifest& session) {
  if (!session.facts().contains("actor")) throw InputError(session.folder() / "session.json", "names no actor");
  const fs::path folder = session.facts().at("actor").get<std::string>();
  return folder.is_absolute() ? folder : session.folder() / folder;
}

rig::Actor load_session_actor(const Manifest& session) {
  rig::Actor actor = rig::load_actor(actor_folder(session));
  rig::read_regions(session, actor);
  return actor;
}

}  // namespace vultus::apps
