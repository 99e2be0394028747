#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/review_data.h"

namespace vultus::apps {

enum class Severity { problem, look, note };

/// Something a reviewer should look at first, with the place to jump to.
struct Finding {
  Severity severity = Severity::note;
  std::string text;
  std::string take, pose, marker;  ///< empty where it does not apply
  int frame = -1;
  nlohmann::json json() const;
};

/// What stands out in a session, most severe first: registrations that did not pass, regional errors above the global
/// ones, the worst markers and frames, long or uncertain gaps, unsteady stabilization, slips of the jig, repairs of
/// labels, warnings of the stages, files that are missing.
std::vector<Finding> find_what_stands_out(const ReviewSession& session);

}  // namespace vultus::apps
