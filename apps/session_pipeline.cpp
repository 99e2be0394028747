#include "apps/session_pipeline.h"

#include <algorithm>

#include "apps/session_actor.h"
#include "apps/session_basis.h"
#include "apps/session_solve.h"
#include "apps/session_takes.h"
#include "core/error.h"
#include "core/files.h"
#include "core/manifest.h"
#include "rig/markers.h"

namespace vultus::apps {
namespace {

namespace fs = std::filesystem;

// The training take goes first: the session's head coordinates are its own.
std::vector<SessionTake> all_takes(const SessionOptions& options) {
  std::vector<fs::path> files = options.takes;
  const auto is_training = [&](const fs::path& file) {
    return fs::exists(file) && fs::equivalent(file, options.training);
  };
  if (!options.training.empty()) {
    if (!fs::exists(options.training)) throw InputError(options.training, "is no take: no such file");
    const auto given = std::find_if(files.begin(), files.end(), is_training);
    if (given != files.end()) files.erase(given);
    files.insert(files.begin(), options.training);
  }
  return session_takes(files);
}

std::vector<SessionTake> performances(const std::vector<SessionTake>& takes, const SessionOptions& options) {
  if (options.training.empty()) return takes;
  std::vector<SessionTake> result(takes.begin() + 1, takes.end());
  const auto same = [&](const fs::path& file) { return fs::equivalent(file, options.training); };
  if (std::any_of(options.takes.begin(), options.takes.end(), same)) result.insert(result.begin(), takes.front());
  return result;
}

// What a studio delivers lies together: markers.json beside the takes says where the markers sit.
fs::path marker_file(const SessionOptions& options) {
  if (!options.markers.empty()) return options.markers;
  const fs::path beside = options.takes.front().parent_path() / "markers.json";
  return fs::exists(beside) ? beside : fs::path();
}

std::map<std::string, std::string> shared_inputs(const SessionOptions& options, const std::vector<SessionTake>& takes,
                                                 const Manifest& session) {
  std::map<std::string, std::string> inputs = {{"actor", sha256_of_file(options.actor / "actor.json")},
                                               {options.training.empty() ? "neutral take" : "training",
                                                session.hash(take_artefact(takes.front().name, "clean.c3d"))}};
  const fs::path markers = marker_file(options);
  if (!markers.empty()) inputs["markers"] = sha256_of_file(markers);
  const fs::path list = options.training.empty() ? fs::path() : training_list(options.training);
  if (!list.empty()) inputs["training poses"] = sha256_of_file(list);
  return inputs;
}

bool is_current(const Manifest& session, const std::vector<std::string>& artefacts, const Provenance& provenance) {
  return std::all_of(artefacts.begin(), artefacts.end(),
                     [&](const auto& name) { return session.is_current(name, provenance); });
}

nlohmann::json options_json(const SessionOptions& options) {
  return {{"regions", options.regions},
          {"neutral_frame", options.neutral_frame},
          {"solver", options.solver},
          {"smoothing", options.smoothing},
          {"seed", options.seed}};
}

class Session {
 public:
  Session(const SessionOptions& options, Progress& progress)
      : options_(options), progress_(progress), manifest_(opened(options)) {}

  SessionResult run() {
    if (!fs::exists(options_.actor / "actor.json")) rig::load_actor(options_.actor);  // says what is missing
    std::vector<SessionTake> takes = all_takes(options_);
    mocap::CleanOptions cleaning;
    cleaning.gaps.seed = options_.seed;
    cleaning.repair_labels = !options_.keep_labels;
    clean_takes(takes, cleaning, manifest_, progress_);
    for (const SessionTake& take : takes) {
      for (const std::string& line : take.report.warnings) result_.warnings.push_back(take.name + ": " + line);
    }
    provenance_ = {"session", options_json(options_), shared_inputs(options_, takes, manifest_)};
    const std::vector<SessionTake> performed = performances(takes, options_);
    write_facts(performed);
    for (const SessionTake& take : performed) {
      progress_.check();
      ++result_.takes;
      finish_take(take, takes.front());
    }
    return std::move(result_);
  }

 private:
  static Manifest opened(const SessionOptions& options) {
    const fs::path file = options.session / "session.json";
    std::error_code ignored;
    if (options.force) fs::remove(file, ignored);
    return Manifest::open(file, "session");
  }

  void write_facts(const std::vector<SessionTake>& performed) {
    nlohmann::json names = nlohmann::json::array();
    for (const SessionTake& take : performed) names.push_back(take.name);
    manifest_.facts()["actor"] = fs::absolute(options_.actor).lexically_normal().string();
    manifest_.facts()["takes"] = names;
    manifest_.facts()["solver"] = options_.solver;
    manifest_.save();
  }

  void finish_take(const SessionTake& take, const SessionTake& first) {
    Provenance provenance = provenance_;
    provenance.inputs["clean take"] = manifest_.hash(take_artefact(take.name, "clean.c3d"));
    if (is_current(manifest_, solved_artefacts(take.name), provenance) &&
        manifest_.is_current("markers.json", provenance_)) {
      ++result_.reused;
      result_.tables[take.name] = read_json(manifest_.folder() / take_artefact(take.name, "report.json")).at("table");
      return;
    }
    prepare(first);
    progress_.begin("solving " + take.name, 0);
    result_.tables[take.name] = solve_and_write(take, *setup_, provenance, manifest_, progress_);
  }

  // Actor, basis and marker places: only when some take needs solving.
  void prepare(const SessionTake& first) {
    if (setup_) return;
    progress_.begin("preparing the marker basis", 0);
    actor_ = session_actor(options_.actor, options_.regions, options_.seed, manifest_);
    const bool training = !options_.training.empty();
    basis_ = session_basis(training ? training_poses(first, marker_file(options_), *actor_)
                                    : neutral_only(first, options_.neutral_frame, *actor_),
                           training, marker_file(options_), *actor_);
    result_.warnings.insert(result_.warnings.end(), basis_->warnings.begin(), basis_->warnings.end());
    // The training take need not be one of the takes on the page.
    for (const std::string& line : training ? first.report.warnings : std::vector<std::string>())
      basis_->warnings.push_back("training take " + first.name + ": " + line);
    rig::write_markers(manifest_.folder() / "markers.json", basis_->placement.by_label());
    manifest_.record("markers.json", provenance_);
    manifest_.facts()["decisions"] = basis_->decisions;
    manifest_.facts()["warnings"] = basis_->warnings;
    manifest_.save();
    for (const std::string& line : basis_->decisions) progress_.note(line);
    retarget::SolveOptions solve;
    solve.smoothing = options_.smoothing;
    setup_.emplace(SolveSetup{*actor_, *basis_, solve, options_.solver == "qp",
                              compared_divisions(*actor_, *basis_, options_.seed), basis_->decisions,
                              basis_->warnings});
  }

  const SessionOptions& options_;
  Progress& progress_;
  Manifest manifest_;
  Provenance provenance_;
  std::optional<rig::Actor> actor_;
  std::optional<SessionBasis> basis_;
  std::optional<SolveSetup> setup_;
  SessionResult result_;
};

}  // namespace

SessionResult run_session(const SessionOptions& options, Progress& progress) {
  return Session(options, progress).run();
}

}  // namespace vultus::apps
