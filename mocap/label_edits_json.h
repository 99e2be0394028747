#pragma once

#include <nlohmann/json.hpp>

#include "mocap/label_edits.h"

namespace vultus::mocap {

/// One edit as labels.json and samples.json have it: {"kind", "frames", "score", "why", "applied", "moves"}.
nlohmann::json json_of(const LabelEdit& edit);
/// Throws an exception that says what is malformed, without the file.
LabelEdit edit_of(const nlohmann::json& json);

}  // namespace vultus::mocap
