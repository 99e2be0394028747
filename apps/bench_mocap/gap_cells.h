#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/progress.h"
#include "mocap/take.h"

namespace vultus::apps::bench_mocap {

inline constexpr std::array<double, 4> kGapSeconds{0.1, 0.5, 1.0, 2.0};
inline constexpr std::array<int, 3> kGapCounts{1, 3, 6};  ///< neighbouring markers hidden at once

/// "0.1", "0.5", "1", "2".
std::string gap_key(double seconds);

/// What came of the gaps of one length and number of markers; sums are over samples.
struct GapCell {
  double seconds = 0.0;
  int count = 0;
  int trials = 0;                                     ///< gaps of `count` markers
  double samples = 0.0, errors = 0.0, covered = 0.0;  ///< filled samples, mm, samples within the expected error
  double holes = 0.0;                                 ///< samples left as holes; interpolated ones do not count either
  double interpolation = 0.0;                         ///< mm, by the best of the three of each cell

  GapCell& operator+=(const GapCell& other);
  double mean() const { return errors / samples; }
  double ratio() const { return errors / interpolation; }
  double coverage() const { return covered / samples; }
};

/// Cuts `trials` gaps at places where nothing is missing into a take in head coordinates: a random marker and its
/// nearest ones on average, no two gaps at the same time; fills them in batches by `mocap::fill_gaps`, which sees
/// nothing of what was cut. The trials are spread evenly over the takes.
GapCell measure_cell(const std::vector<mocap::Take>& steady, double seconds, int count, int trials, std::uint64_t seed,
                     Progress& progress);

}  // namespace vultus::apps::bench_mocap
