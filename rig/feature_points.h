#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh.h"
#include "register/template.h"

namespace vultus::rig {

/// MPEG-4 feature point (ISO/IEC 14496-2 annex C) of each iBUG point that has one, such as {30, "9.3"} for the nose
/// tip.
const std::vector<std::pair<int, std::string>>& mpeg4_names();

/// The 68-point scheme of a topology: `ibug68` where given, completed from landmarks with MPEG-4 names; -1 where
/// neither has a point.
registration::Ibug68 face_points(const Topology& topology, const std::optional<registration::Ibug68>& ibug68);

}  // namespace vultus::rig
