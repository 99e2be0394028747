#pragma once

#include <array>
#include <vector>

#include "core/mesh.h"

namespace vultus::scan {

/// Triangles in progress of being cleaned: positions and per-corner UV rows, nothing promised about connectivity.
struct Soup {
  Points positions;
  Points colours;  ///< 0 rows, or one a position
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::array<int, 3>> uv_rows;  ///< empty, or one a triangle
};

Soup soup_from(const Mesh& mesh);

/// Drops the triangles for which `keep` is false, with their UV rows.
void keep_triangles(Soup& soup, const std::vector<bool>& keep);

/// Removes vertices that no triangle uses; returns how many.
int drop_unused(Soup& soup);

/// Makes every edge have at most two triangles with opposite directions and every vertex one fan, by turning triangles
/// around and doubling vertices (CGAL). Returns the number of doubled vertices. Surfaces that are so already are
/// returned as they are.
int orient(Soup& soup);

/// Fills boundary loops no longer than `longest` mm, refined to the density around and faired (CGAL; Liepa 2003).
/// New triangles are appended; their corners have no UVs of their own and take the rim's. Returns the number of holes.
int fill_holes(Soup& soup, double longest);

/// Edge-collapse decimation by quadric error (Garland & Heckbert 1997; OpenMesh) down to about `triangles`. UVs are
/// dropped: a collapsed corner has none.
void decimate(Soup& soup, int triangles);

}  // namespace vultus::scan
