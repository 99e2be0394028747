#pragma once

#include <cstdint>
#include <vector>

#include "mocap/gap_methods.h"

namespace vultus::mocap {

inline constexpr int kTrialCrowd = 5;  ///< neighbours hidden with a trial's marker at most

/// A gap cut into samples that are known.
struct GapTrial {
  Gap gap;
  std::vector<TakeView::Hidden> hidden;  ///< the gap, what an edge hides before it, and some neighbours
  bool edge = false;
  int crowd = 0;  ///< neighbours among them
};

/// `count` gaps of `length` frames at random places where a marker is seen throughout, with none to five of its
/// neighbours hidden over the same frames; with `edge`, all before the gap is hidden too. Fewer where the take does not
/// offer them. The same seed gives the same gaps.
std::vector<GapTrial> cut_trials(const Take& take, const RigidGroups& groups, int length, bool edge, int count,
                                 std::uint64_t seed);

}  // namespace vultus::mocap
