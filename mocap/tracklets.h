#pragma once

#include <string>
#include <vector>

#include "mocap/take.h"

namespace vultus::mocap {

/// A stretch of one column without a gap or a jump: one object, whatever its label.
struct Tracklet {
  int column = 0, first = 0, last = 0;  ///< frames, both ends
  int frames() const { return last - first + 1; }
};

/// Cuts every column at its gaps and wherever the straight continuations of both sides (from up to three samples each)
/// miss by more than `jump_mm` and by more than eight times what is usual for the column. By column, then by frame.
std::vector<Tracklet> cut_tracklets(const Take& take, double jump_mm);

/// True for the names that trackers give to what they could not label: "*7", "point_7", "Unlabeled 1001", "U_7",
/// "" … (any case, after a subject's "NAME:").
bool is_unlabelled(const std::string& label);

}  // namespace vultus::mocap
