#pragma once

#include "core/progress.h"
#include "register/method.h"

namespace vultus::registration {

/// The default method on a neutral: Zhu's RBF start, then non-rigid refinement (`fit_nonrigid`).
Fit fit_standard_neutral(const FitInput& input, Progress& progress);

/// The default method on another pose, from the same person's registered neutral: the skull found robustly, the jaw
/// turned, then non-rigid refinement that keeps the neutral's shape locally.
Fit fit_standard_expression(const FitInput& input, const Registered& neutral, Progress& progress);

}  // namespace vultus::registration
