#pragma once

#include <vector>

#include "register/planar_bones.h"
#include "register/template.h"

namespace vultus::registration {

struct ControlPointOptions {
  double face_spacing =
      13.0;  ///< mm, > 0, along the skin: gaps between landmarks are filled to this in the set "face" …
  double far_spacing = 28.0;   ///< … and to this elsewhere; without such a set all skin is face
  double least_spacing = 3.0;  ///< mm, ≥ 0: of two landmarks that lie closer only the first is taken
  int most = 240;              ///< control points, ≥ 4; gaps left over then are the narrowest
  void validate() const;       ///< throws `InputError`
};

/// Where a template carries its control surface.
struct SkinControls {
  std::vector<int> vertices;  ///< of the topology given, one a control point
  Triangles triangles;        ///< bones, rows of `vertices`
  BoneMasks masks;
  /// The surface on a shape of the topology (vertex_count×3, mm).
  ControlSurface on(const Points& positions) const { return {positions(vertices, Eigen::all), triangles}; }
};

/// Control points on the template's landmarks (eyes, nose and lips first), gaps between them filled by points farthest
/// from all others, triangulated as the dual of the cells they have on `skin` (distances along edges), so that no bone
/// spans lips or lids. `topology` is the template's, refined or not; control vertices keep their numbers in it.
///
/// Masks (Sánchez §4.3) are found rather than painted, where the template names the 68-point scheme: skin nearer to the
/// upper lip's landmarks than to the lower's, along the skin, is barred from bones of the lower lip, and so for lids.
/// Throws `InputError` when the skin carries fewer than 4 control points or no bone.
SkinControls make_controls(const Template& head, const Topology& topology, const Points& positions,
                           const std::vector<bool>& skin, const ControlPointOptions& options = {});

}  // namespace vultus::registration
