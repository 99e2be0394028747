#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "mocap/clean.h"

namespace vultus::apps {

/// Frames as read to frames of the cleaned take, which has no doubled ones.
class CleanedFrames {
 public:
  explicit CleanedFrames(std::vector<mocap::RepeatNote> repeats) : doubled_(std::move(repeats)) {
    std::erase_if(doubled_, [](const auto& repeat) { return repeat.kind != mocap::Repeat::Kind::doubled; });
  }
  /// A frame that was taken out becomes the one after it.
  int operator()(int frame) const {
    int out = 0;
    for (const mocap::RepeatNote& doubled : doubled_)
      out += std::clamp(frame - doubled.first, 0, doubled.last - doubled.first + 1);
    return frame - out;
  }

 private:
  std::vector<mocap::RepeatNote> doubled_;
};

}  // namespace vultus::apps
