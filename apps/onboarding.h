#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/progress.h"

namespace vultus::apps {

struct OnboardOptions {
  std::filesystem::path capture, actor;
  std::filesystem::path template_path;  ///< template.obj or its folder; empty: the databank's, else the built-in head
  std::filesystem::path databank;       ///< actor folder whose expressions are brought by motion transfer; may be empty
  std::vector<std::string> poses;       ///< wanted, scanned or of the databank; empty: all. The neutral always comes
  std::string method = "default";       ///< of registration, "default", "zhu" or "sanchez"
  std::string landmarks_by = "automatic";  ///< what finds landmarks, "automatic", "dlib" or "geometry"
  std::string energy_solver = "ceres";     ///< of the method "sanchez", "ceres" or "simplex"
  std::string transfer = "gradient";       ///< of motion from the databank, "gradient" or "zhu"
  int regions = 6;                         ///< the face is divided into, 1 to 64
  std::uint64_t seed = 1;
  bool force = false;
  double memory_gb = 0.0;  ///< 10⁹ bytes that scans processed side by side may take; 0: four fifths of the available
};

/// What became of each pose, and what there is to tell.
struct OnboardResult {
  int registered = 0, transferred = 0, reused = 0;
  std::vector<std::string> failed;  ///< "POSE: reason"; these poses are not in the actor
  std::vector<std::string> warnings;
  nlohmann::json report;       ///< report/registration.json (apps/review_data.h)
  bool below_quality = false;  ///< a registration failed its quality gate
};

/// Raw scans to an actor folder (DESIGN §2): every scan cleaned and registered, missing expressions brought from the
/// databank, regions found. Poses whose scan, template and options are as before are left alone; each finished pose is
/// on disk before the next batch begins, so that a run cut short continues.
OnboardResult onboard_actor(const OnboardOptions& options, Progress& progress);

}  // namespace vultus::apps
