#pragma once

#include <vector>

#include "core/progress.h"
#include "register/graph_fit.h"
#include "register/scan_surface.h"

namespace vultus::registration {

struct NonrigidOptions {
  double fine_spacing = 7.0;      ///< mm between nodes within 25 mm of `detail` points
  double face_spacing = 12.0;     ///< in the set "face"
  double far_spacing = 22.0;      ///< elsewhere
  double first_stiffness = 30.0;  ///< annealed geometrically …
  double last_stiffness = 0.03;   ///< … against one unit of data a node
  double first_limit = 15.0;      ///< mm: farthest correspondence at the start …
  double last_limit = 3.0;        ///< … and at the end
  double first_landmarks = 2.0;   ///< landmark weight, times confidence, at the start …
  double last_landmarks = 0.02;   ///< … and at the end
  double least_cosine = 0.5;      ///< between normals
  bool free_scale = true;         ///< pieces may grow (another person); false: locally rigid (the same person)
  int stages = 7, steps_a_stage = 4;
  int landmark_steps = 0;  ///< steps under landmarks alone before any data counts, at a tenth of the first stiffness
  double landmark_relaxation = 0.9;  ///< [0, 1]: how far the shape they give becomes the one that stiffness keeps
  void validate() const;             ///< throws `InputError`
};

struct NonrigidResult {
  Points positions;  ///< vertex_count×3, scan frame
  int steps = 0;
  double initial_error = 0.0, final_error = 0.0;  ///< mean distance of vertices with data from the scan, mm
};

/// Non-rigid refinement: a deformation graph over `rest`, started at `start`, drawn to the scan's tangent planes by
/// robust weights and to landmarks, its local stiffness annealed (after Li et al. 2008), then normal projection of what
/// is left (`project_smoothly`). Vertices that are not `fitted` follow the graph or, in pieces of their own, rigidly.
/// `detail` (k×3, rest frame) are places that deserve more nodes: eyes, nose, lips.
NonrigidResult fit_nonrigid(const Topology& topology, const Points& rest, const Points& start,
                            const std::vector<bool>& fitted, const ScanSurface& scan,
                            const std::vector<PointTerm>& landmarks, const Points& detail,
                            const NonrigidOptions& options = {}, Progress& progress = Progress::none());

}  // namespace vultus::registration
