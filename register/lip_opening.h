#pragma once

#include "core/rays.h"
#include "register/anchors.h"

namespace vultus::registration {

/// Sets the anchors of the lips' inner edges (points 61–63 and 65–67) by the scan's own shape, which tells a closed
/// mouth from a narrow gap where pictures do not: along three lines from upper to lower lip, seen from the front, the
/// surface falls back between the lips' crests. Where most lines find what lies deep no wider than a seam, the mouth is
/// closed: both anchors of a line keep their middle and lie as far apart as in `rest`, the person's neutral (or the
/// template) moved into the scan. Else they come to lie on the edges of what is deep, and missing ones are added. Lines
/// without a furrow and anchors placed by hand (confidence 1) stay. Scan in mm.
Anchors with_inner_lips(const Template& head, Anchors anchors, const Points& rest, const RayScene& rays);

}  // namespace vultus::registration
