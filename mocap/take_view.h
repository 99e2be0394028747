#pragma once

#include <vector>

#include "mocap/take.h"

namespace vultus::mocap {

/// A take with some stretches hidden, so that filling can be tried on samples that are known.
struct TakeView {
  struct Hidden {
    int marker, first, last;
  };
  const Take& take;
  std::vector<Hidden> hidden;

  bool has(int frame, int marker) const {
    if (frame < 0 || frame >= take.frames() || !take.has(frame, marker)) return false;
    for (const Hidden& h : hidden) {
      if (h.marker == marker && frame >= h.first && frame <= h.last) return false;
    }
    return true;
  }
  Eigen::Vector3d at(int frame, int marker) const { return take.at(frame, marker); }
};

}  // namespace vultus::mocap
