#pragma once

#include <vector>

#include "core/rbf.h"
#include "core/transform.h"
#include "register/anchors.h"
#include "register/scan_surface.h"

namespace vultus::registration {

/// The line that cylindrical projection goes about: through the head's centre, parallel to y (Zhu §4.5.2).
struct HeadAxis {
  Eigen::Vector3d point, direction;  ///< scan frame, mm; unit
};
HeadAxis head_axis(const Points& neutral, const std::vector<bool>& fitted, const Similarity& scan_from_template);

/// RBF warp of template space onto the scan (Zhu §4.3) through the anchors; where none is near, through `vertices`
/// moved by the alignment and set onto the scan by a ray (Zhu §4.2), so that the warp stays put where no landmark says
/// anything.
RbfMap start_warp(const Points& vertices, const std::vector<bool>& fitted, const Anchors& anchors,
                  const Similarity& scan_from_template, const ScanSurface& scan,
                  RbfKernel kernel = RbfKernel::multiquadric);

}  // namespace vultus::registration
