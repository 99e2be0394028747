#pragma once

#include <memory>

#include "core/mesh.h"

namespace vultus::registration {

/// Loop's subdivision of one topology (Loop 1987; Zhu §4.4), evaluated for any number of poses: every refined position
/// is a fixed weighted sum of control positions, kept as a stencil table (OpenSubdiv).
///
/// Polygons are subdivided as their triangulated view. Boundaries are smooth curves that do not depend on the
/// interior. Control vertex v is refined vertex v; the vertices born on edges follow, level by level. UVs are smooth
/// inside a chart and linear along its border, so that charts keep their outline. A refined vertex belongs to a named
/// set when all vertices of the edge it was born on do; landmarks keep their vertex.
class LoopSubdivision {
 public:
  /// `levels` 0 … 6; 0 leaves the topology as it is (polygons too). Throws `InputError` for other levels or a mesh that
  /// OpenSubdiv refuses.
  LoopSubdivision(std::shared_ptr<const Topology> control, int levels);

  const std::shared_ptr<const Topology>& control() const { return control_; }
  const std::shared_ptr<const Topology>& refined() const { return refined_; }

  /// Refined positions of a pose of the control mesh (control vertex_count×3); throws `InputError` for another size.
  Points operator()(const Points& control_positions) const;

 private:
  struct Stencils;
  std::shared_ptr<const Topology> control_, refined_;
  std::shared_ptr<const Stencils> stencils_;  // null for zero levels
};

}  // namespace vultus::registration
