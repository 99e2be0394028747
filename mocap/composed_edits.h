#pragma once

#include <vector>

#include "mocap/label_edits.h"

namespace vultus::mocap {

/// One list that does to a raw take what `first` and then `second` (edits of the take that `first` leads to) do: the
/// moves of `second` start from the raw take's columns, and `first` loses the frames that `second` moves on. An edit
/// of the list that is then refused by hand leaves its samples under the labels that they came with. In order of their
/// first frames.
std::vector<LabelEdit> composed(const std::vector<LabelEdit>& first, const std::vector<LabelEdit>& second);

}  // namespace vultus::mocap
