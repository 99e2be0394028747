#pragma once

#include "register/convex_map.h"

namespace vultus::registration::layout {

/// Moves a disc's inner vertices to lessen its distortion, from a one-to-one start `uv`: minimizes the symmetric
/// Dirichlet energy Σ area (‖J‖² + ‖J⁻¹‖²), J from the triangle scaled by its importance to the chart (Smith and
/// Schaefer 2015), by conjugate gradients preconditioned with the uniform Laplacian. No step turns a triangle over, nor
/// one of a hole's fan, so that the map stays one-to-one. `steps` iterations at most.
Uvs relaxed_map(const Disc& disc, const Uvs& uv, int steps);

}  // namespace vultus::registration::layout
