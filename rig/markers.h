#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/mesh.h"

namespace vultus::rig {

/// Marker label → place on a topology.
using MarkerPlaces = std::map<std::string, SurfacePoint>;

/// Reads `{"markers": {"LABEL": {"triangle": 12, "barycentric": [a, b, c]} | {"landmark": "8.1"} | {"vertex": 7}, …}}`.
/// Triangles count in the triangulated view; barycentric coordinates are ≥ 0 and sum to one within 1e-4 (they are then
/// normalized). A landmark or vertex becomes a corner of the lowest-numbered triangle that has it. Throws `InputError`
/// naming file and label; an unknown landmark comes with the nearest name.
MarkerPlaces read_markers(const std::filesystem::path& file, const Topology& topology);
void write_markers(const std::filesystem::path& file, const MarkerPlaces& markers);

/// One entry of such a file; errors name `file` and `where`.
SurfacePoint place_from_json(const nlohmann::json& entry, const Topology& topology, const std::filesystem::path& file,
                             const std::string& where);

/// The place of a vertex: a corner of the lowest-numbered triangle that has it; invalid for a vertex without faces.
SurfacePoint place_of_vertex(const Topology& topology, int vertex);

}  // namespace vultus::rig
