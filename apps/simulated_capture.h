#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/virtual_stage/stage.h"

namespace vultus::apps {

/// Runs the virtual stage into `folder` (capture/, truth/) and records what it made in simulation.json, unless all of
/// it is there already, made by the same options, and `force` is false. Returns false when nothing was to be done.
bool simulate_once(const std::filesystem::path& folder, const virtual_stage::StageOptions& options, bool force,
                   Progress& progress);

/// The takes of a simulated capture beside the training take, in order.
std::vector<std::filesystem::path> simulated_takes(const std::filesystem::path& folder,
                                                   const virtual_stage::StageOptions& options);

}  // namespace vultus::apps
