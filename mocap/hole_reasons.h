#pragma once

#include <string>
#include <vector>

#include "mocap/clean.h"

namespace vultus::mocap {

/// Why a gap of a cleaned take was left a hole: "the marker is never seen", "fewer than three other markers are seen in
/// 40 of its 52 frames", or "the expected error is too large".
std::string hole_reason(const CleanReport& report, const Gap& gap);

/// For the report: how many gaps were left holes for which reason. Empty without holes.
std::vector<std::string> hole_reasons(const CleanReport& report);

}  // namespace vultus::mocap
