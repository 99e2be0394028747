#pragma once

#include "register/detect_landmarks.h"
#include "register/face_finder.h"
#include "register/template.h"

namespace vultus::registration {

/// A template that names no landmarks (an OBJ alone), with those that the finder sees on its own shape: each of the
/// 68-point scheme is the skin's vertex nearest to the place where it was seen, the jaw's outline (0–16) and points
/// that no view showed are -1, and a vertex is given to one point only. A shape that is not upright and looking along
/// +z is turned by quarter turns until it is.
/// Throws `InputError` when no face is seen or hardly a landmark of it.
Template with_found_landmarks(Template head, const FaceFinder& finder);

/// The same from what was seen on the template's refined shape.
Template with_seen_landmarks(Template head, const DetectedLandmarks& seen);

}  // namespace vultus::registration
