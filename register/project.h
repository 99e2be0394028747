#pragma once

#include <vector>

#include "core/mesh.h"
#include "register/scan_surface.h"

namespace vultus::registration {

struct ProjectOptions {
  double max_displacement = 10.0;  ///< mm, > 0: a vertex whose ray meets the scan farther away is not moved by it
  double least_cosine = 0.3;       ///< between template and scan normal, [-1, 1]
  bool fill = true;                ///< vertices without a hit follow their neighbours smoothly; false leaves them
};

struct Projection {
  Points positions;       ///< vertex_count×3, scan frame
  std::vector<bool> hit;  ///< vertices that lie on the scan now
};

/// Zhu §4.5.2: each vertex goes along the ray that is perpendicular to the line through `axis_point` along the unit
/// `axis`, to where it meets the scan. Rays do not cross one another, so the mesh cannot fold. Departs from the paper
/// in asking the surfaces to face the same way and in letting vertices without a hit follow their neighbours.
/// `movable` (vertex_count) names the vertices to project.
Projection project_cylindrically(const Topology& topology, const Points& positions, const std::vector<bool>& movable,
                                 const ScanSurface& scan, const Eigen::Vector3d& axis_point,
                                 const Eigen::Vector3d& axis, const ProjectOptions& options = {});

/// Zhu §4.5.1: the same along each vertex's normal.
Projection project_along_normals(const Topology& topology, const Points& positions, const std::vector<bool>& movable,
                                 const ScanSurface& scan, const ProjectOptions& options = {});

}  // namespace vultus::registration
