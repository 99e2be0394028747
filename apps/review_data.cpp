#include "apps/review_data.h"

#include <algorithm>

#include "apps/session_actor.h"
#include "core/error.h"
#include "core/files.h"
#include "core/manifest.h"
#include "rig/markers.h"

namespace vultus::apps {
namespace fs = std::filesystem;
namespace {

bool there(const fs::path& file) {
  std::error_code ignored;
  return fs::exists(file, ignored);
}

nlohmann::json object_or_empty(const fs::path& file, ReviewSession& session) {
  if (!there(file)) {
    session.missing.push_back(fs::relative(file, session.folder).generic_string());
    return nlohmann::json::object();
  }
  nlohmann::json json = read_json(file);
  if (!json.is_object()) throw InputError(file, "must be a JSON object");
  return json;
}

std::optional<retarget::MarkerErrors> errors_of(const fs::path& file, ReviewSession& session) {
  if (there(file)) return retarget::read_errors(file);
  session.missing.push_back(fs::relative(file, session.folder).generic_string());
  return {};
}

ReviewTake read_take_results(const std::string& name, ReviewSession& session) {
  const fs::path folder = session.folder / "takes" / name;
  ReviewTake take;
  take.name = name;
  take.report = object_or_empty(folder / "report.json", session);
  if (there(folder / "samples.json")) {
    take.samples = mocap::read_samples(folder / "samples.json");
  } else {
    session.missing.push_back("takes/" + name + "/samples.json");
  }
  if (there(folder / "measured.c3d") && there(folder / "clean.c3d")) {
    take.measured = mocap::read_take(folder / "measured.c3d");
    take.clean = mocap::read_take(folder / "clean.c3d");
  }
  if (there(folder / "weights.npy")) {
    take.weights = retarget::read_weights(folder / "weights.npy");
  } else {
    session.missing.push_back("takes/" + name + "/weights.npy");
  }
  take.errors = errors_of(folder / "errors.csv", session);
  if (there(folder / "errors_global.csv")) take.global_errors = retarget::read_errors(folder / "errors_global.csv");
  if (take.weights && take.errors && take.weights->frames() != take.errors->frames()) {
    throw InputError(folder / "errors.csv", std::to_string(take.errors->frames()) + " frames where weights.npy has " +
                                                std::to_string(take.weights->frames()));
  }
  return take;
}

std::vector<std::string> take_names(const ReviewSession& session) {
  std::vector<std::string> names;
  if (session.facts.contains("takes") && session.facts["takes"].is_array()) {
    for (const auto& take : session.facts["takes"]) {
      if (take.is_string()) names.push_back(take.get<std::string>());
      if (take.is_object() && take.contains("name")) names.push_back(take["name"].get<std::string>());
    }
  }
  if (!names.empty()) return names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(session.folder / "takes", ignored)) {
    if (entry.is_directory()) names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

double ReviewTake::rate_hz() const {
  if (weights) return weights->rate_hz;
  return errors && errors->rate_hz > 0.0 ? errors->rate_hz : 0.0;
}

int ReviewTake::frames() const {
  if (weights) return weights->frames();
  return errors ? errors->frames() : 0;
}

ReviewSession read_review_session(const fs::path& folder) {
  const fs::path manifest_file = folder / "session.json";
  if (!there(manifest_file)) throw InputError(manifest_file, "is missing; a session folder is needed");
  const Manifest manifest = Manifest::open(manifest_file, "session");
  ReviewSession session;
  session.folder = fs::absolute(folder).lexically_normal();
  session.facts = manifest.facts();
  for (const std::string& artefact : manifest.artefacts()) session.hashes[artefact] = manifest.hash(artefact);
  session.actor_folder = actor_folder(manifest);
  session.actor = load_session_actor(manifest);
  const fs::path registration = session.actor_folder / "report" / "registration.json";
  if (there(registration)) {
    session.registration = read_json(registration);
  } else {
    session.missing.push_back("the actor's report/registration.json");
  }
  const fs::path markers = session.folder / "markers.json";
  session.markers = there(markers) ? rig::read_markers(markers, *session.actor.topology) : session.actor.markers;
  for (const std::string& name : take_names(session)) session.takes.push_back(read_take_results(name, session));
  return session;
}

}  // namespace vultus::apps
