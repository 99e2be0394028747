#pragma once

#include <vector>

#include "apps/virtual_stage/mocap_volume.h"
#include "mocap/rigid_body.h"

namespace vultus::virtual_stage {

/// RMS in mm of the head motion that a stabilization leaves: points fixed to the true head (the face markers of the
/// first frame) are carried by the true motion and taken back by the estimated one; what they still move about their
/// mean, once the constant motion between the two head frames is taken out, counts. Over the frames with a pose.
double head_motion_left(const RecordedTake& recorded, int face_markers, const std::vector<mocap::HeadPose>& poses);

}  // namespace vultus::virtual_stage
