#pragma once

#include <cstdint>

#include "mocap/take.h"

namespace vultus::apps::bench_mocap {

struct LongTakeOptions {
  double seconds = 600.0;  ///< > 0
  double missing = 0.02;   ///< share of all samples lost in bursts of 3 to 40 frames, 0 … 0.5
  double noise = 0.1;      ///< mm, each coordinate, ≥ 0
  std::uint64_t seed = 1;
};

/// A long take of the virtual stage: 99 face and 5 jig markers at 120 Hz with head motion. One minute is performed and
/// recorded; it runs forward and backward until the time is full, with new noise and new bursts throughout.
mocap::Take long_take(const LongTakeOptions& options = {});

}  // namespace vultus::apps::bench_mocap
