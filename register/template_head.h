#pragma once

#include <utility>
#include <vector>

#include "register/template.h"

namespace vultus::registration {

/// The head Vultus ships: a left/right symmetric control mesh of triangles, to be Loop-subdivided twice. Hand-placed
/// rings around eyes and mouth, nose and face rows are woven into strips, faired, and set back so that the smoothed
/// surface comes near the placed points.
///
/// Frame: mm, +y up, face along +z, origin midway between the outer eye corners and 18 mm behind the corneas.
/// Parts: skin with the mouth cavity (open at the neck and behind the lids), two closed eyeballs, two rows of teeth.
///
/// Sets: face, back_of_head, rigid, neck, ears, ear_left, ear_right, lips, upper_lip, lower_lip, lids,
/// {upper,lower}_lid_{left,right}, lid_margin_{left,right}, eyeballs, eyeball_{left,right}, iris_{left,right},
/// nostrils, inner_mouth, mouth_cavity, mouth_lining (with the lips' inner edge), teeth, teeth_upper, teeth_lower,
/// neck_boundary, skin. Eye and mouth corners are in `lids` and `lips` alone.
Template template_head();

/// The vertex on the other side of each control vertex; itself on the midline.
std::vector<int> template_mirror();

using VertexPairs = std::vector<std::pair<int, int>>;
/// (upper, lower) vertices of the inner lips that touch while the mouth is closed, as in the neutral head.
VertexPairs lip_seal();
/// (upper, lower) vertices of the lid margins that touch while the eye is closed.
VertexPairs lid_seal_left();
VertexPairs lid_seal_right();

/// The sphere that an eyeball of the smoothed head is; the lids slide on it.
struct EyeSphere {
  Eigen::Vector3d centre;  ///< mm
  double radius;           ///< mm
};
EyeSphere eye_sphere_left();
EyeSphere eye_sphere_right();

}  // namespace vultus::registration
