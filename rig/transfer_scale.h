#pragma once

#include "core/mesh.h"
#include "register/template.h"

namespace vultus::rig {

/// Zhu 2006 eq. 5.2: how much larger a target face is than a source, the mean of four ratios. The thesis draws the four
/// distances in figure 5.1 without a table; they are taken here as
///   x₁  between the middles of the eyes, each halfway between its corners (iBUG 36, 39 and 42, 45; MPEG-4 3.12, 3.8
///       and 3.11, 3.7),
///   x₂  width of the mouth (48, 54; 8.4, 8.3),
///   y₁  height from the eyes' middle to the base of the nose (33; 9.15),
///   y₂  height from the base of the nose to the chin (8; 2.1).
struct TransferScale {
  double eyes = 1.0, mouth = 1.0, upper = 1.0, lower = 1.0;  ///< target / source
  double mean() const { return 0.25 * (eyes + mouth + upper + lower); }
};

/// Points are vertices of the 68-point scheme (rig/feature_points.h). Throws `InputError` naming a point that either
/// face lacks.
TransferScale transfer_scale(const Points& source_neutral, const registration::Ibug68& source_points,
                             const Points& target_neutral, const registration::Ibug68& target_points);

}  // namespace vultus::rig
