#pragma once

#include "register/landmarks.h"
#include "register/scan_surface.h"

namespace vultus::registration {

/// True when `given` names most of the template's major feature points (Zhu §4.2: 28 of 172), which is what a person
/// places for the semi-automatic way.
bool are_major_landmarks(const Template& head, const ScanLandmarks& given);

/// Zhu §4.2: the template's other feature points from the `known` ones. Each is carried by the affine map of the known
/// points about it (weighted by nearness; where those lie in a plane, the similarity of all of them decides across it)
/// into the view that shows it, front, side, back or top, and a ray through it gives its depth on the scan. Points
/// that the ray misses stay where the map put them, with little confidence; so little have those far from known ones.
/// Returns only points whose vertices are not known yet; none when fewer than 6 are known. Departs from the paper,
/// whose maps are in the front view, by views for points that the front does not show.
ScanLandmarks place_minor_landmarks(const Template& head, const ScanLandmarks& known, const ScanSurface& scan);

}  // namespace vultus::registration
