#pragma once

#include <filesystem>

#include "core/mesh.h"

namespace vultus {

/// Reads OBJ (polygons, UVs, negative indices, vertex colours, groups ignored, map_Kd of its .mtl), PLY (ascii, both
/// binaries; colours, quads, points only) or STL (ascii, binary; equal corners welded), by extension and content.
/// Positions stay in the file's units. Throws `InputError` with file and line or byte for anything malformed:
/// truncation, counts larger than the file could hold, non-finite coordinates, indices out of range.
/// `NonFinite::keep` lets scans with NaN vertices through for cleaning.
enum class NonFinite { refuse, keep };
Mesh read_mesh(const std::filesystem::path& file, NonFinite non_finite = NonFinite::refuse);

/// Writes polygons and per-corner UVs; names of vertex sets and landmarks are not part of OBJ.
void write_obj(const std::filesystem::path& file, const Mesh& mesh);
/// Binary little-endian PLY, float32 positions, uint8 sRGB colours where the mesh has them.
void write_ply(const std::filesystem::path& file, const Mesh& mesh);
/// Same with `texture_uv`-less points only: n×3 positions, optional normals.
void write_ply_points(const std::filesystem::path& file, const Points& positions, const Points& normals = {});

}  // namespace vultus
