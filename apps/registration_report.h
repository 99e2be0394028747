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

/// The same of a scan that could not be registered: the verdict is a failure, with the reason in words and the way out.
nlohmann::json unregistered_report(const std::string& pose, const std::string& problem);

/// A line for the log: "smile: pass, 0.21 mm".
std::string summary_line(const nlohmann::json& pose_report);

}  // namespace vultus::apps
