#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mocap/take.h"

namespace vultus::mocap {

/// Leaves out, in place as takes are large, every frame whose flag is 0; `file_frames` says which are left.
void keep_frames(const std::vector<std::uint8_t>& keep, Take& take);

/// The same for markers.
void keep_markers(const std::vector<std::uint8_t>& keep, Take& take);

/// A take without samples and otherwise like `take`, but for its columns; residuals and camera masks have room where
/// `take` has them.
Take emptied(const Take& take, std::vector<std::string> labels);

/// Sample `i` of `from`, there or missing, with residual and cameras to `j` of `to`, which has those where `from` does.
void copy_sample(const Take& from, std::size_t i, Take& to, std::size_t j);

}  // namespace vultus::mocap
