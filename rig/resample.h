#pragma once

#include <vector>

#include "core/mesh.h"
#include "register/template.h"

namespace vultus::rig {

/// Where each vertex of a mesh lies on another face's surface (Zhu 2006 §5.2, figure 5.4).
struct Correspondence {
  std::vector<SurfacePoint> places;  ///< for each vertex; invalid where the surface was not found
  Points deformed;                   ///< the mesh brought to the other face by RBF, mm
  double found_share = 0.0;          ///< of all vertices
};

/// Deforms `mesh_neutral` by RBF between the landmarks both faces have, then casts a ray from every vertex along its
/// normal, both ways, at most `search_mm` far; the nearer hit on skin (the largest connected part) that faces the same
/// way counts. Vertices of the sets eyeball_left, eyeball_right, teeth_upper and teeth_lower take the nearest place of
/// the surface's set of that name, where it has one. Throws `InputError` for fewer than 8 common landmarks.
Correspondence correspond(const Topology& mesh, const Points& mesh_neutral, const registration::Ibug68& mesh_points,
                          const Topology& surface, const Points& surface_neutral,
                          const registration::Ibug68& surface_points, double search_mm);

/// Motion (n×3, mm) at the found places, continued harmonically over the mesh's edges to the others, then averaged over
/// one-rings `smoothing_rounds` times (Zhu §5.2). Parts of the mesh that found nothing stay still.
Points resample_motion(const Topology& mesh, const Correspondence& correspondence, const Topology& surface,
                       const Points& surface_motion, int smoothing_rounds);

}  // namespace vultus::rig
