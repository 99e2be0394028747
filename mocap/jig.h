#pragma once

#include <string>
#include <vector>

#include "mocap/stabilize.h"

namespace vultus::mocap {

/// Head poses of one take from the jig markers `labels`, from which slipped markers are taken out one by one, the
/// largest slip first: a loose marker pulls the poses, which makes the others seem to move. Three markers always stay.
/// Fills `result.body` (without what holds for a part of this take only), `slips`, `decisions` and, where it is open,
/// `reference_frame`. Throws `InputError` when fewer than 3 of the markers are seen in the reference frame.
std::vector<HeadPose> jig_poses(const Take& take, const std::vector<std::string>& labels,
                                const StabilizeOptions& options, Stabilized& result);

}  // namespace vultus::mocap
