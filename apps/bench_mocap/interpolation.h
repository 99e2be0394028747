#pragma once

#include <array>

#include "core/mesh.h"

namespace vultus::apps::bench_mocap {

/// A gap bridged from the samples before and after it, the yardsticks of filling: linear, PCHIP (monotone cubic
/// Hermite; Fritsch and Butland 1984) and natural cubic spline. `before` and `after` are samples of consecutive frames,
/// mm, each at least two rows; `length` frames are missing between them. Each result has `length` rows.
std::array<Points, 3> interpolations(const Points& before, const Points& after, int length);

}  // namespace vultus::apps::bench_mocap
