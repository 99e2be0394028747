#pragma once

#include "mocap/take.h"

namespace vultus::mocap {

enum class Smoothing {
  none,
  three_frame,  ///< mean of the frame and its two neighbours (Zhu 2006 §6.1)
  butterworth,  ///< low pass of second order, run forward and backward: no phase shift, fourth order in all
  gaussian,     ///< weights exp(-t²/2s²) cut at 3 s
};

struct FilterOptions {
  Smoothing smoothing = Smoothing::butterworth;
  double cutoff_hz = 12.0;       ///< Butterworth: half power (both runs together); at or above half the rate: no effect
  double sigma_seconds = 0.008;  ///< Gaussian: s, > 0
  void validate() const;         ///< throws `UsageError`
};

/// Smooths every marker over each stretch without holes; nothing is smoothed across a hole, and no sample appears or
/// disappears. Ends of a stretch are continued by point reflection, so that straight motion stays as it is.
Take smoothed(Take take, const FilterOptions& options = {});

}  // namespace vultus::mocap
