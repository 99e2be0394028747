#include "apps/simulated_capture.h"

#include <algorithm>

#include "apps/virtual_stage/performances.h"
#include "core/manifest.h"

namespace vultus::apps {
namespace {

namespace fs = std::filesystem;

nlohmann::json json_of(const virtual_stage::StageOptions& options) {
  return {{"seed", options.seed},
          {"poses", options.poses},
          {"triangles", options.scan_triangles},
          {"scan_noise", options.scan_noise},
          {"clutter", options.clutter},
          {"landmarks", options.landmarks},
          {"performances", options.performances},
          {"seconds", options.performance_seconds},
          {"hold_seconds", options.hold_seconds},
          {"marker_noise", options.marker_noise},
          {"marker_missing", options.marker_missing},
          {"faults", options.faults},
          {"mocap", options.mocap}};
}

std::vector<std::string> files_below(const fs::path& folder) {
  std::vector<std::string> files;
  for (const char* part : {"capture", "truth"}) {
    for (const auto& entry : fs::recursive_directory_iterator(folder / part)) {
      if (entry.is_regular_file()) files.push_back(fs::relative(entry.path(), folder).generic_string());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

bool simulate_once(const fs::path& folder, const virtual_stage::StageOptions& options, bool force, Progress& progress) {
  options.validate();
  const fs::path file = folder / "simulation.json";
  const Provenance provenance{"simulate", json_of(options), {}};
  std::error_code ignored;
  if (force) fs::remove(file, ignored);
  Manifest manifest = Manifest::open(file, "simulation");
  const std::vector<std::string> made = manifest.artefacts();
  const auto is_current = [&](const std::string& name) { return manifest.is_current(name, provenance); };
  if (!made.empty() && std::all_of(made.begin(), made.end(), is_current)) return false;

  // What an earlier run with other options left would be taken for part of the capture.
  for (const std::string& name : made) fs::remove(folder / name, ignored);
  for (const std::string& name : made) manifest.forget(name);
  virtual_stage::simulate(folder, options, progress);
  for (const std::string& name : files_below(folder)) manifest.record(name, provenance);
  manifest.save();
  return true;
}

std::vector<fs::path> simulated_takes(const fs::path& folder, const virtual_stage::StageOptions& options) {
  std::vector<fs::path> takes;
  if (!options.mocap) return takes;
  const auto& names = options.performances.empty() ? virtual_stage::performance_names() : options.performances;
  for (const std::string& name : names) takes.push_back(folder / "capture" / "mocap" / (name + ".c3d"));
  return takes;
}

}  // namespace vultus::apps
