#pragma once

#include <string>
#include <vector>

#include "rig/actor.h"
#include "rig/segmentation.h"

namespace vultus::rig {

/// Names that say where regions lie, from the 68-point scheme or MPEG-4 names of the actor's topology: brow, eye,
/// cheek, nose, mouth (its corners), upper_lip, lower_lip, jaw or neck, with _left or _right (the subject's) unless the
/// region spans the face. A vertex votes, with the strength of its motion, for the nearest of these places; a region is
/// called by most of its votes, the strongest claim first; a place that is taken gives way to the next, and in the end
/// to a number. Without landmarks regions are called region_1, region_2, ….
std::vector<std::string> region_names(const Actor& actor, const Segmentation& segmentation);

}  // namespace vultus::rig
