#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/progress.h"
#include "rig/database.h"

namespace vultus::apps {

struct TransferredPoses {
  int transferred = 0, reused = 0;
};

/// Brings the named expressions of a databank (loaded from `folder`) to the actor by motion transfer and writes each
/// with an entry of the registration report (report/<pose>.json). Poses that are current stay as they are.
TransferredPoses transfer_poses(const rig::Actor& databank, const std::filesystem::path& folder,
                                const std::vector<std::string>& poses, rig::ActorWriter& writer, Progress& progress);

}  // namespace vultus::apps
