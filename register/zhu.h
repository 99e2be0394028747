#pragma once

#include "register/method.h"

namespace vultus::registration {

/// Zhu's consistent parameterization as published (§4.3–4.7): RBF deformation of the control mesh, Loop subdivision,
/// cylindrical projection with a displacement limit, orientation. Every pose starts from the template; `reference`
/// (refined topology, face frame) is what its orientation is made to agree with: the template or the person's neutral.
Fit fit_zhu(const FitInput& input, const Points& reference);

}  // namespace vultus::registration
