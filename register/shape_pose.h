#pragma once

#include <optional>
#include <vector>

#include "core/transform.h"
#include "register/scan_surface.h"

namespace vultus::registration {

/// How a face's shape lies in a scan.
struct ShapePose {
  Similarity scan_from_face;
  double score = 0.0;      ///< [0, 1]: mean over the face of how near the scan lies and how alike it is turned
  double runner_up = 0.0;  ///< score of the best pose that is another one; near `score` where the shape is no help
};

/// Finds `face` (a mesh in mm, looking along its +z, nose tip at vertex `nose_tip`, `skin` its vertices that a scan
/// shows) in a scan of unknown pose by shape alone: every place of the scan that stands out like a nose, in all rolls
/// about the direction in which it stands out, starts an iterated closest-point alignment; the fit with the best
/// robust score wins. The scan's unit must be about right (a head within 0.7 to 1.4 of the face's size).
/// Nothing when no place stands out.
std::optional<ShapePose> find_shape_pose(const Mesh& face, const std::vector<int>& skin, int nose_tip,
                                         const ScanSurface& scan);

}  // namespace vultus::registration
