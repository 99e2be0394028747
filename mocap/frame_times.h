#pragma once

#include <vector>

#include "mocap/take.h"

namespace vultus::mocap {

/// Puts a take whose frames carry times on the even time line that everything else relies on, and says in
/// `take.decisions` what it found:
/// - a rate other than the stated one (clocks that drift: by a line through the times): the take's own rate is used;
/// - times that leap: missing frames are put in, at most as many as the take has;
/// - frames with the time of the one after: taken out;
/// - times off the even line by more than a tenth of a frame anywhere: samples are interpolated onto it by cubic
///   Hermite, only between frames that both have the marker.
/// `times_s` has one time a frame, seconds; NaN where the file gives none. `step_s` is how finely the file prints its
/// times, ≥ 0: differences within it are its rounding. Times that do not rise are left alone and reported.
void to_even_times(Take& take, const std::vector<double>& times_s, double step_s);

}  // namespace vultus::mocap
