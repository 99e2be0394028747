#pragma once

#include "core/mesh.h"
#include "register/template_layout.h"

namespace vultus::registration::layout {

/// Hand-placed positions smoothed to least bending: minimizes Σ‖Lp‖² + Σ hold‖p − placed‖² over the skin, L the
/// uniform umbrella operator. n×3, mm; mirror symmetric to the last bit.
Points faired(const Weave& whole);

/// Control positions whose Loop limit comes near `target`: `rounds` steps of p += set_back·(target − limit(p)).
Points loop_controls(const Weave& whole, const Points& target, int rounds);

/// Loop limit positions of the control vertices (Loop 1987; boundary vertices by the cubic B-spline rule).
Points loop_limit(const Weave& whole, const Points& control);

}  // namespace vultus::registration::layout
