#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/capture.h"
#include "register/consistent.h"

namespace vultus::apps {

/// The entry of one registered scan in report/registration.json (see apps/review_data.h).
nlohmann::json pose_report(const CapturedPose& pose, const registration::Registered& registered,
                           const std::vector<std::string>& cleaning);

/// A line for the log: "smile: pass, 0.21 mm".
std::string summary_line(const nlohmann::json& pose_report);

}  // namespace vultus::apps
