#pragma once

#include "apps/virtual_stage/complexion.h"
#include "core/image.h"
#include "core/texture_space.h"

namespace vultus::virtual_stage {

/// Albedo of a whole head in texture space, linear RGB: skin with blood, freckles and mottling, lips, brows of single
/// hairs, lid lines, cropped scalp hair, eyes, teeth and mouth cavity; the gutter is filled.
///
/// `space` is of the template head's topology, as it is or subdivided; `reference` are the positions (vertex_count×3,
/// mm) of the template's neutral on it, whoever the actor is: the pattern lies on the same skin for everyone.
Image skin_albedo(const TextureSpace& space, const Points& reference, const Complexion& complexion);

}  // namespace vultus::virtual_stage
