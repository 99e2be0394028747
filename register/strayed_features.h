#pragma once

#include <vector>

#include "register/anchors.h"
#include "register/graph_fit.h"

namespace vultus::registration {

/// Features that a fit has left beside where they were found: both eyes and, where the scan has `coloured` skin, both
/// brows, which shape alone lets slide over the forehead. A finder is off by millimetres at one point and far less in
/// the mean of all points of a feature, so each feature is moved as a whole, by what its mean is off beyond 1 mm, or
/// 2.5 mm where pictures show bare shape.
/// `positions` (refined vertices, mm) is the fit; anchors placed by hand (confidence 1) take no part, features with
/// fewer than three others are left alone. One term an anchor of each feature that has strayed, weights 1.
std::vector<PointTerm> strayed_features(const Anchors& anchors, const Points& positions, bool coloured);

}  // namespace vultus::registration
