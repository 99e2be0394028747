#pragma once

#include <algorithm>
#include <vector>

#include "mocap/clean.h"

namespace vultus::apps {

/// Frames as read to frames of the cleaned take, which has no doubled ones.
class CleanedFrames {
 public:
  explicit CleanedFrames(const std::vector<mocap::RepeatNote>& repeats) {
    for (const mocap::RepeatNote& repeat : repeats) {
      for (int f = repeat.first; repeat.kind == mocap::Repeat::Kind::doubled && f <= repeat.last; ++f)
        out_.push_back(f);
    }
    std::ranges::sort(out_);
  }
  /// A frame that was taken out becomes the one after it.
  int operator()(int frame) const {
    return frame - static_cast<int>(std::ranges::lower_bound(out_, frame) - out_.begin());
  }

 private:
  std::vector<int> out_;  // frames as read
};

}  // namespace vultus::apps
