#pragma once

#include <vector>

#include "register/anchors.h"
#include "register/graph_fit.h"
#include "register/scan_surface.h"

namespace vultus::registration {

/// How far the lower jaw has turned about its hinge since the neutral.
struct JawOpening {
  double angle = 0.0;            ///< radians, ≥ 0; 0 also where it cannot be told
  std::vector<PointTerm> terms;  ///< chin vertices where the turn takes them; none for a closed jaw
};

/// Finds the turn about the line between the ends of the jaw contour (points 0, 1 and 15, 16) that brings the chin to
/// the scan and the lower lip to its landmarks. A chin has no landmark of its own that stays on the skin when the mouth
/// opens, and elastic stiffness alone leaves it behind between lip and neck. `rest` is the neutral in the scan frame.
JawOpening find_jaw_opening(const Template& head, const Topology& topology, const Points& rest,
                            const std::vector<bool>& fitted, const Anchors& anchors, const ScanSurface& scan);

}  // namespace vultus::registration
