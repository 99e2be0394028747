#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace vultus::apps {

/// The page ACTOR/report/index.html: verdicts, where to look first, and for each pose its picture (scan, result,
/// distance, what was removed), reasons, regions and what was done to the scan. Opens from disk; pictures lie beside
/// it. `report` is registration.json (apps/review_data.h).
std::string actor_report_page(const std::string& actor, const nlohmann::json& report);

}  // namespace vultus::apps
