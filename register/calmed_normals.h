#pragma once

#include "core/mesh.h"

namespace vultus::registration {

/// Unit vertex normals (vertex_count×3) of a scan, averaged `rounds` times over the neighbouring triangles so that they
/// span more than a scanner's noise.
Points calmed_normals(const Mesh& scan, int rounds);

}  // namespace vultus::registration
