#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/progress.h"

namespace vultus::apps {

struct SessionOptions {
  std::vector<std::filesystem::path> takes;
  std::filesystem::path actor, session;
  std::filesystem::path training;  ///< empty: the basis comes from the rig's surface
  std::filesystem::path markers;   ///< anchors or places (retarget/anchors.h); empty: markers.json beside the takes,
                                   ///< else the actor's own
  int regions = 0;                 ///< 0: the actor's own
  int neutral_frame = -1;          ///< of the first take, without a training take; -1: found
  std::string solver = "qp";       ///< "qp": by region (Liu eq. 2), "global": one set of weights (eq. 1)
  double smoothing = 0.0;          ///< of the weights over time, s (Liu §7)
  bool keep_labels = false;        ///< swaps, fragments and phantoms are left as they are
  std::uint64_t seed = 1;
  bool force = false;
};

struct SessionResult {
  int takes = 0, reused = 0;  ///< performances, and those whose results were current
  std::vector<std::string> warnings;
  nlohmann::json tables;  ///< take → Liu's table 1
};

/// Raw takes to a session folder (DESIGN §2): cleaned, solved, errors measured. Work whose inputs and options are as
/// before is left alone; a run cut short continues at the take it was at.
SessionResult run_session(const SessionOptions& options, Progress& progress);

}  // namespace vultus::apps
