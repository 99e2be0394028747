#pragma once

#include <vector>

#include "mocap/take.h"

namespace vultus::mocap {

struct SpikeOptions {
  double least_mm = 1.0;          ///< smaller jumps are left alone, > 0
  double factor = 8.0;            ///< a spike is this many times the marker's usual scatter, > 1
  double longest_seconds = 0.02;  ///< longer ones may be a blink; at least one frame counts, in [0, 0.1]
  void validate() const;          ///< throws `UsageError`
};

struct Spike {
  int marker = 0, first = 0, last = 0;
  double size = 0.0;  ///< mm from where the samples around put it, the largest
};

/// Samples that jump away from the line through the medians of the frames before and after and come back within
/// `longest_seconds`. The scatter is each marker's own (the median of the same distances); a jump must also stand out
/// from those around it, so that the turning points of fast motion stay.
std::vector<Spike> find_spikes(const Take& take, const SpikeOptions& options = {});

/// The take with the spikes' samples missing.
Take without(Take take, const std::vector<Spike>& spikes);

}  // namespace vultus::mocap
