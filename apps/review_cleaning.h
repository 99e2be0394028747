#pragma once

#include <nlohmann/json.hpp>

#include "apps/review_data.h"

namespace vultus::apps {

/// What cleaning did to a take, for the page (apps/review/{gaps,repairs,cleaning}.js):
///
///     gaps            [{"marker", "first", "last", "method", "expected_error_mm"}…]
///     repairs         [{"kind": "swap" | "moved" | "fragment" | "phantom" | "spike" | "held" | "doubled" | "marker" |
///                       "slip" | "refused", "first", "last", "markers": [LABEL…], "what": TEXT,
///                       "marks": [[LABEL, first, last]…]}…] by frame; `marks`: where in the gap chart
///     stabilization   {"method", "rms", "rms_mm": [x or null…], "slips": [{"marker", "frame", "distance_mm"}…]}
///     curves          {"labels", "least", "measured", "clean", "expected"}: positions above `least`, expected errors
///
/// All frames are those of the cleaned take. Parts that the take has no files for are left out.
nlohmann::json cleaning_json(const ReviewTake& take);

}  // namespace vultus::apps
