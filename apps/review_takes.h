#pragma once

#include <nlohmann/json.hpp>

#include "apps/review_data.h"

namespace vultus::apps {

/// A take for the page: names, weights, errors (all frames where they fit, else every n-th: "stride"), Liu's table 1,
/// per-marker figures, gaps, stabilization, decisions. Arrays are base64; see apps/review/data.js for their types.
nlohmann::json take_json(const ReviewTake& take);

}  // namespace vultus::apps
