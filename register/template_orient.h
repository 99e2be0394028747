#pragma once

#include "register/template_layout.h"

namespace vultus::registration::layout {

/// Turns triangles so that neighbours agree and each connected part faces away from its middle.
/// Every edge must have one or two triangles.
void orient_outward(Weave& weave);

}  // namespace vultus::registration::layout
