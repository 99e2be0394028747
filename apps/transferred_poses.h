#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/progress.h"
#include "rig/database.h"

namespace vultus::apps {

struct TransferredPoses {
  int transferred = 0, reused = 0;
  std::vector<std::string> decisions;
};

/// Brings the named expressions of a databank (loaded from `folder`) to the actor by motion transfer
/// (rig/motion_transfer.h, `method` "gradient" or "zhu") and writes each with its entry of the registration report
/// (report/<pose>.json). Poses that are current stay as they are.
TransferredPoses transfer_poses(const rig::Actor& databank, const std::filesystem::path& folder,
                                const std::vector<std::string>& poses, const std::string& method,
                                rig::ActorWriter& writer, Progress& progress);

}  // namespace vultus::apps
