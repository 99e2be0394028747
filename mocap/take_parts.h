#pragma once

#include <cstdint>
#include <vector>

#include "mocap/take.h"

namespace vultus::mocap {

/// Leaves out, in place as takes are large, every frame whose flag is 0; `file_frames` says which are left.
void keep_frames(const std::vector<std::uint8_t>& keep, Take& take);

/// The same for markers.
void keep_markers(const std::vector<std::uint8_t>& keep, Take& take);

}  // namespace vultus::mocap
