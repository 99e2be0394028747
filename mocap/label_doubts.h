#pragma once

#include <string>
#include <vector>

#include "mocap/label_evidence.h"

namespace vultus::mocap {

/// What should be looked at before repaired labels are trusted, a sentence each; empty where nothing is found. In a
/// short take, where a swap that lasts is as usual as what is right, a repair may leave one or make half of it:
/// - labels that leap into each other's places: the two ends of a swap that is still there;
/// - a long stretch dropped from a label because another's samples took its place: half of a swap, of which the other
///   half fits nothing;
/// - more than one sample in a hundred under a wrong label: too many for each to be told from what is right.
/// `original`: the label that each tracklet of the evidence bore before the repair, -1: none. Frames count as in the
/// take that came.
std::vector<std::string> label_doubts(const LabelEvidence& evidence, const std::vector<int>& original);

}  // namespace vultus::mocap
