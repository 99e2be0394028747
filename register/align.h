#pragma once

#include <vector>

#include "core/transform.h"
#include "register/landmarks.h"
#include "register/scan_surface.h"

namespace vultus::registration {

struct Alignment {
  Similarity scan_from_template;
  Eigen::VectorXd residuals;  ///< mm at the pairs given (landmarks) or at the vertices that took part (surface)
  double rms = 0.0;           ///< robust, mm
};

/// Similarity (or rigid motion) that brings template points onto scan points (both n×3, rows correspond), trusting rows
/// by `confidence` and leaving outliers aside (Tukey). Throws `InputError` for fewer than 4 usable pairs.
Alignment align_landmarks(const Points& template_points, const Points& scan_points, const Eigen::VectorXd& confidence,
                          Scaling scaling);

struct RigidRefinement {
  int iterations = 30;        ///< most steps
  double first_limit = 20.0;  ///< mm: farthest correspondence at the start …
  double last_limit = 3.0;    ///< … and at the end
  double least_cosine = 0.6;  ///< between normals
};

/// Robust point-to-plane iteration of the given vertices against the scan, from `start` (template → scan).
/// Vertices that find no place within the limit wait; Tukey's weights keep what moved (brows, cheeks) from pulling.
/// Point-to-plane: Chen & Medioni 1992. With too few correspondences the start comes back with rms < 0.
Alignment align_surface(const Topology& topology, const Points& positions, const std::vector<int>& vertices,
                        const ScanSurface& scan, const Similarity& start, Scaling scaling,
                        const RigidRefinement& options = {});

}  // namespace vultus::registration
