#include "apps/session_takes.h"

#include <algorithm>
#include <optional>

#include "core/error.h"

namespace vultus::apps {
namespace {

namespace fs = std::filesystem;

nlohmann::json options_json(const mocap::CleanOptions& options) {
  return {{"head", static_cast<int>(options.head.method)},   {"jig", options.head.jig},
          {"reference_frame", options.head.reference_frame}, {"smoothing", static_cast<int>(options.filter.smoothing)},
          {"cutoff_hz", options.filter.cutoff_hz},           {"seed", options.gaps.seed},
          {"repair_labels", options.repair_labels}};
}

// Changes of labels that somebody has looked through lie beside the take; empty where there are none.
fs::path label_list(const fs::path& take) {
  const fs::path list = fs::path(take).replace_extension(".labels.json");
  return fs::exists(list) ? list : fs::path();
}

class TakeCleaner {
 public:
  TakeCleaner(const SessionTake& first, mocap::CleanOptions options, Manifest& session, Progress& progress)
      : first_(first),
        options_(std::move(options)),
        session_(session),
        progress_(progress),
        first_hash_(sha256_of_file(first.file)) {}

  /// True when the take's files were already there.
  bool clean(SessionTake& take) {
    Provenance provenance{
        "session", options_json(options_), {{"take", sha256_of_file(take.file)}, {"head", first_hash_}}};
    for (const auto& [name, file] :
         {std::pair{"labels", label_list(take.file)}, {"head's labels", label_list(first_.file)}})
      if (!file.empty()) provenance.inputs[name] = sha256_of_file(file);
    const std::string clean_file = take_artefact(take.name, "clean.c3d"),
                      samples = take_artefact(take.name, "samples.json"),
                      labels = take_artefact(take.name, "labels.json"),
                      measured = take_artefact(take.name, "measured.c3d");
    const bool current = session_.is_current(clean_file, provenance) && session_.is_current(samples, provenance) &&
                         session_.is_current(labels, provenance) && session_.is_current(measured, provenance);
    if (!current) {
      const mocap::Cleaned cleaned = cleaned_take(take.file);
      mocap::write_take(session_.folder() / clean_file, cleaned.take);
      mocap::write_take(session_.folder() / measured, cleaned.measured);
      mocap::write_samples(session_.folder() / samples, cleaned.report);
      mocap::write_edits(session_.folder() / labels, cleaned.label_edits);
      for (const std::string& name : {clean_file, samples, labels, measured}) session_.record(name, provenance);
      session_.save();
    }
    // Read back even when just written, so that a run cut short and continued gives the same bytes.
    take.clean = mocap::read_take(session_.folder() / clean_file);
    take.clean.name = take.name;
    take.report = mocap::read_samples(session_.folder() / samples);
    take.clean.file_frames = take.report.file_frames;
    return current;
  }

 private:
  mocap::Cleaned cleaned_take(const fs::path& file) {
    if (!body_ && file != first_.file) body_ = cleaned(first_.file).body;
    mocap::Cleaned result = cleaned(file);
    if (!body_) body_ = result.body;
    return result;
  }

  mocap::Cleaned cleaned(const fs::path& file) {
    mocap::CleanOptions options = options_;
    options.head.body = body_;
    options.keep_measured = true;
    try {
      if (options.repair_labels && !label_list(file).empty()) options.label_edits = mocap::read_edits(label_list(file));
      return mocap::clean(mocap::read_take(file), options, progress_);
    } catch (const InputError& error) {
      const std::string message = error.what();
      if (message.starts_with(file.string())) throw;
      throw InputError(file, message);
    }
  }

  const SessionTake& first_;
  mocap::CleanOptions options_;
  Manifest& session_;
  Progress& progress_;
  std::string first_hash_;
  std::optional<mocap::RigidBody> body_;
};

}  // namespace

std::string take_artefact(const std::string& take, const std::string& file) { return "takes/" + take + "/" + file; }

std::vector<SessionTake> session_takes(const std::vector<fs::path>& files) {
  std::vector<SessionTake> takes;
  for (const fs::path& file : files) {
    std::error_code error;
    if (!fs::is_regular_file(file, error)) throw InputError(file, "is no take: no such file");
    const std::string name = file.stem().string();
    for (const SessionTake& other : takes) {
      if (other.name == name)
        throw UsageError("two takes are called \"" + name + "\": " + other.file.string() + " and " + file.string());
    }
    takes.push_back({name, file, {}, {}});
  }
  return takes;
}

int clean_takes(std::vector<SessionTake>& takes, const mocap::CleanOptions& options, Manifest& session,
                Progress& progress) {
  int reused = 0;
  TakeCleaner cleaner(takes.front(), options, session, progress);
  for (SessionTake& take : takes) {
    progress.check();
    if (cleaner.clean(take)) ++reused;
  }
  return reused;
}

}  // namespace vultus::apps
