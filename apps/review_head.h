#pragma once

#include <nlohmann/json.hpp>

#include "apps/review_data.h"

namespace vultus::apps {

/// The actor's head for the page's 3D viewer: triangles and neutral of what a camera sees, the poses as sparse motion
/// (0.005 mm steps), region masks, scan distances and colours per vertex, and the places of the markers. Arrays are
/// base64; see apps/review/head.js for their types.
nlohmann::json head_json(const ReviewSession& session);

}  // namespace vultus::apps
