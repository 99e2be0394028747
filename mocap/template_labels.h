#pragma once

#include "mocap/labels.h"
#include "mocap/rigid_body.h"

namespace vultus::mocap {

/// Labels from where another take of the same markers has them (see `marker_layout`), for a take in which markers of
/// the layout go without: the layout is laid over the frame that it fits best and followed from there both ways; each
/// unlabelled tracklet gets the label that it matches in most of the frames looked at, and none when that is in doubt.
/// Labels that the take has stay and help to place the layout. Then `repair_labels` looks for swaps and phantoms; all
/// changes are one list of edits of the raw take. Throws `InputError` when the layout does not fit the take, or fits
/// about as well turned round: by less than one marker.
Relabelled label_from_layout(const Take& raw, const RigidBody& layout, const LabelOptions& options = {});

}  // namespace vultus::mocap
