#include "apps/transferred_poses.h"

#include "core/error.h"

namespace vultus::apps {

TransferredPoses transfer_poses(const rig::Actor&, const std::filesystem::path&, const std::vector<std::string>&,
                                rig::ActorWriter&, Progress&) {
  throw ToolError("motion transfer is not there");
}

}  // namespace vultus::apps
