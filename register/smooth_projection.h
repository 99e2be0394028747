#pragma once

#include <vector>

#include "core/mesh.h"
#include "register/scan_surface.h"

namespace vultus::registration {

struct SmoothProjectionOptions {
  double limit = 3.0;         ///< mm, > 0: farther scan does not pull
  double least_cosine = 0.8;  ///< between normals: around a rim, what lies near is another side of it
  double bending = 0.1;  ///< ≥ 0: of Σ (mean of neighbours' offsets − own)², against one unit a vertex with data
  double membrane = 0.002;  ///< ≥ 0: of Σ_edges (offset difference)²
  double stay = 0.2;        ///< ≥ 0: of offset² where a vertex is in no comparison; bending alone would run on far
  int rounds = 3;           ///< correspondences are found anew each round
};

/// Draws a mesh that nearly fits onto the scan along its own normals: the offsets h minimize Σ w (distance to the
/// scan's tangent plane)² over vertices and edge midpoints + bending + membrane, by sparse Cholesky. Only normal
/// movement, so vertices do not slide; where there is no data the offset dies away smoothly.
Points project_smoothly(const Topology& topology, const Points& positions, const std::vector<bool>& fitted,
                        const ScanSurface& scan, const SmoothProjectionOptions& options = {});

}  // namespace vultus::registration
