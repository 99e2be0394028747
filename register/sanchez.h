#pragma once

#include "core/progress.h"
#include "register/method.h"

namespace vultus::registration {

/// Sánchez's energy registration (Sánchez et al. 2003, §6) as a complete method, on a neutral: RBF warp through the
/// landmarks (eqs. 13–16) and cylindrical projection as a start, then the control surface of planar bones (§4) moved so
/// that distance + strain + bending become least (eqs. 17, 18).
///
/// Choices where the paper leaves them: the control points are the template's landmarks and points that fill the gaps
/// between them (`make_controls`); the initial configuration that strain and bending keep is the template's own shape,
/// scaled and turned onto the scan, so that errors of landmarks do not become part of it; far from every landmark the
/// warp is held by template points on the scan (`start_warp`); what the bones are too coarse for is in the end
/// projected along normals, since the paper stops at markers and a registration must not.
Fit fit_sanchez_neutral(const FitInput& input, Progress& progress);

/// The same on another pose, from the same person's registered neutral: the head's rigid motion, the control points
/// moved as the landmarks moved (spread over the control surface, so that lips part), then the energy, which now keeps
/// the neutral's shape.
Fit fit_sanchez_expression(const FitInput& input, const Registered& neutral, Progress& progress);

}  // namespace vultus::registration
