#pragma once

#include "register/detect_landmarks.h"
#include "register/refined_template.h"

namespace vultus::registration {

/// Landmarks from shape alone, without colour, picture or model file: the face's shape is found in the scan in any pose
/// (`find_shape_pose`), bent onto it stiffly, and its named points are carried along. `shape` (refined topology, mm) is
/// the template's own, or the neutral of the person, which helps with expressions; `same_person` tells which. Points
/// are the template's 68-point scheme where it has one, else its own landmarks; confidences stay below those of points
/// seen in pictures and fall with the distance that is left. Throws `InputError` when no place of the scan fits a face.
DetectedLandmarks detect_landmarks_by_shape(const RefinedTemplate& model, const Points& shape, bool same_person,
                                            const Mesh& scan);

}  // namespace vultus::registration
