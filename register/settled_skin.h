#pragma once

#include <vector>

#include "register/anchors.h"
#include "register/graph_fit.h"
#include "register/refined_template.h"
#include "register/scan_surface.h"

namespace vultus::registration {

/// Skin that has not moved against the skull since the neutral, held where it is (weight in [0, 1] a vertex): skin
/// above the lips that lies on the scan as it is, well away from skin that does not and from landmarks that have moved.
/// Data say nothing along the surface, and without this a pose that moves the brows slides the cheeks. `rest` is the
/// neutral in the scan frame (refined vertices).
std::vector<PointTerm> settled_skin(const RefinedTemplate& model, const Points& rest, const Anchors& anchors,
                                    const ScanSurface& scan);

}  // namespace vultus::registration
