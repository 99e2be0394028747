#pragma once

#include "mocap/labels.h"
#include "mocap/rigid_body.h"

namespace vultus::mocap {

/// Labels for a take that has none, or fewer than eight, from where another take of the same markers has them (see
/// `marker_layout`): the layout is laid over its most complete frame and followed from there both ways; each tracklet
/// gets the label that it matches in most of the frames looked at, and none when that is in doubt. Labels that the take
/// has already stay. Every label is an edit of the raw take. Takes with eight labels or more go to `repair_labels`
/// instead, and `decisions` says so. Throws `InputError` when the layout does not
/// fit the take.
Relabelled label_from_layout(const Take& raw, const RigidBody& layout, const LabelOptions& options = {});

}  // namespace vultus::mocap
