#pragma once

#include <vector>

#include "register/template.h"
#include "register/template_layout.h"

namespace vultus::registration::layout {

/// The 172 landmarks: the feature points of MPEG-4 (ISO/IEC 14496-2, groups 2–11; without tongue, teeth and hair
/// thickness), then hair line, side hair, neck, back of the head and jaw line by plain names ending in _left or _right.
std::vector<Landmark> landmarks(const Weave& whole);

/// The 68-point scheme of iBUG/Multi-PIE in dlib's order.
Ibug68 ibug68(const Weave& whole);

}  // namespace vultus::registration::layout
