#pragma once

#include <optional>
#include <vector>

#include "core/transform.h"
#include "register/anchors.h"
#include "register/graph_fit.h"
#include "register/mouth_gape.h"
#include "register/scan_surface.h"
#include "register/template.h"

namespace vultus::registration {

/// How the chin has moved against the skull since the neutral.
struct JawOpening {
  double angle = 0.0;            ///< radians, ≥ 0: turn of the chin
  double drop = 0.0;             ///< mm that the chin's point has moved; 0 for a closed jaw or where it cannot be told
  std::vector<PointTerm> terms;  ///< chin vertices where the motion takes them, and, below a gaping mouth without
                                 ///< colour, neck that stays; none for a closed jaw
  Similarity motion;              ///< rigid, of the chin from `rest`
  std::optional<MouthGape> gape;  ///< what told it, where shape alone shows the lips apart
};

/// Finds the rigid motion of the chin. Where the mouth gapes (`find_gape`), it starts from the rims that shape shows
/// and needs no landmark (`find_gaping_jaw`). Else it brings the chin onto the scan and the lower lip to its landmarks:
/// started from turns about the line between the ends of the jaw contour (points 0, 1 and 15, 16), with and without the
/// lower lip's shift, refined against the scan, the best kept. A chin has no landmark of its own that stays on the skin
/// when the mouth opens, and elastic stiffness alone leaves it behind between lip and neck. `rest` is the neutral in
/// the scan frame.
JawOpening find_jaw_opening(const Template& head, const Topology& topology, const Points& rest,
                            const std::vector<bool>& fitted, const Anchors& anchors, const ScanSurface& scan);

/// Anchors that agree with a gape: found points (confidence below 1) of lips and chin stay where they lie within some
/// millimetres of what skull and jaw make of `rest` there, and the inner lips' (61 to 63 and 65 to 67) come to lie on
/// the gape's rims. Pictures of a gaping mouth without colour put lips anywhere. As they are without a gape.
Anchors agreeing_anchors(const Template& head, const Anchors& anchors, const Points& rest, const JawOpening& jaw);

}  // namespace vultus::registration
