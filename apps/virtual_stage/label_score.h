#pragma once

#include <cstddef>

#include "apps/virtual_stage/volume_faults.h"

namespace vultus::virtual_stage {

/// How a repaired take stands against the truth.
struct LabelScore {
  std::size_t samples = 0, right = 0;  ///< all samples that the cameras gave; right: under their label,
                                       ///< and phantoms dropped
  std::size_t samples_in_swaps = 0, right_in_swaps = 0;  ///< those of the markers of each swap, in its frames
  int swaps_left = 0;                                    ///< swaps with a sample that is not right
};

/// `repaired` has the frames of `faulty.take` and begins with the recorded labels; a sample counts as right where the
/// repaired take has the very position under its true label.
LabelScore score_labels(const FaultyTake& faulty, const mocap::Take& repaired);

}  // namespace vultus::virtual_stage
