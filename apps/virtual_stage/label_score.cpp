#include "apps/virtual_stage/label_score.h"

#include <algorithm>

namespace vultus::virtual_stage {
namespace {

bool same_place(const mocap::Take& a, int column_a, const mocap::Take& b, int column_b, int frame) {
  const float* p = a.positions.data() + 3 * a.index(frame, column_a);
  const float* q = b.positions.data() + 3 * b.index(frame, column_b);
  return std::equal(p, p + 3, q);
}

// Whether the sample is where it belongs.
bool is_right(const FaultyTake& faulty, const mocap::Take& repaired, int frame, int column, int owner) {
  if (owner >= 0) return repaired.has(frame, owner) && same_place(faulty.take, column, repaired, owner, frame);
  for (int m = 0; m < repaired.markers(); ++m) {
    if (repaired.has(frame, m) && same_place(faulty.take, column, repaired, m, frame)) return false;
  }
  return true;
}

}  // namespace

LabelScore score_labels(const FaultyTake& faulty, const mocap::Take& repaired) {
  LabelScore score;
  const int columns = faulty.take.markers();
  std::vector<std::uint8_t> wrong(faulty.owners.size(), 0);
  for (int f = 0; f < faulty.take.frames(); ++f) {
    for (int c = 0; c < columns; ++c) {
      const int owner = faulty.owners[faulty.take.index(f, c)];
      if (owner == FaultyTake::nobody) continue;
      const bool right = is_right(faulty, repaired, f, c, owner);
      ++score.samples;
      score.right += right;
      wrong[faulty.take.index(f, c)] = !right;
    }
  }
  for (const Fault& fault : faulty.faults) {
    if (fault.kind != Fault::Kind::swap) continue;
    bool left = false;
    for (int f = fault.first; f <= fault.last; ++f) {
      for (const int m : fault.markers) {
        if (faulty.owners[faulty.take.index(f, m)] == FaultyTake::nobody) continue;
        ++score.samples_in_swaps;
        const bool bad = wrong[faulty.take.index(f, m)] != 0;
        score.right_in_swaps += !bad;
        left = left || bad;
      }
    }
    score.swaps_left += left;
  }
  return score;
}

}  // namespace vultus::virtual_stage
