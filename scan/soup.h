#pragma once

#include <array>
#include <vector>

#include "core/corners.h"
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

/// Which corners meet at each vertex.
Corners vertex_corners(const Soup& soup);

/// Drops the triangles for which `keep` is false, with their UV rows.
void keep_triangles(Soup& soup, const std::vector<bool>& keep);

/// Removes vertices that no triangle uses; returns how many.
int drop_unused(Soup& soup);

/// Along the triangle's normal, as long as its area.
Eigen::RowVector3d area_vector(const Soup& soup, int triangle);

int drop_non_finite(Soup& soup);       ///< triangles at such vertices go; returns the vertices
int merge_equal_vertices(Soup& soup);  ///< triangles then share the first of several at one place; returns the others
int drop_degenerate(Soup& soup);       ///< triangles without area
int drop_repeated_triangles(Soup& soup);  ///< over the same three vertices, whichever way round

/// Connected pieces (through shared vertices), numbered by first triangle.
struct Pieces {
  std::vector<int> of_triangle;
  std::vector<double> area;  ///< a piece, mm²
};
Pieces pieces_of(const Soup& soup);

/// Removes pieces smaller than `smallest` of the largest one's area, and strands and shreds: pieces with much more
/// border than area. 0 keeps every piece.
struct StrayPieces {
  int pieces = 0, triangles = 0;
};
StrayPieces drop_stray_pieces(Soup& soup, double smallest);

/// Pieces with at least `share` of the largest one's area whose box measures `least_diagonal` mm or more.
int count_large_pieces(const Soup& soup, double share, double least_diagonal);

/// Turns every triangle round when the largest piece looks at its own centre rather than away from it, as heads, faces
/// and any convex shell do. The soup must be oriented. Returns whether it did.
bool turn_outwards(Soup& soup);

/// Takes off vertices that stand out of their surroundings like needles, up to `passes` times (a group of spikes shows
/// its lower ones when the highest are gone); returns how many.
int drop_spikes(Soup& soup, double factor, int passes);

/// Takes out hair-like clutter and groups of spikes: vertices around which (two rings) more than `wildness` of the
/// triangles stand steep on their own corners' normals and normals cancel out. Does nothing where a tenth of the scan
/// is like that: it is then noise finer than the sampling. Returns how many vertices.
int drop_clutter(Soup& soup, double wildness);

/// Takes off spikes that a border grows, from their tips inwards: border vertices all of whose edges are `factor` times
/// longer than the scan's usual ones. Returns how many vertices.
int drop_border_spikes(Soup& soup, double factor, int passes);

/// Open borders; ones that touch count as one.
int count_boundaries(const Soup& soup);

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
