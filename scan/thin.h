#pragma once

#include "core/mesh.h"

namespace vultus::scan {

/// A coarse copy for first looks and coarse steps: vertices that share a cell of a grid of `cell` (scan units, > 0)
/// become one at their mean, with their mean colour; triangles within a cell go (vertex clustering, Rossignac & Borrel
/// 1993). Linear in the scan's size where edge collapse takes 20 times longer. UVs are dropped; sheets nearer to one
/// another than a cell may join, so that the copy need not be manifold.
Mesh thinned(const Mesh& scan, double cell);

}  // namespace vultus::scan
