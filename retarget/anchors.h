#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "rig/actor.h"
#include "rig/markers.h"

namespace vultus::retarget {

/// What a person says about where markers sit on the rig: the few anchors from which the others follow, or full places.
struct Anchors {
  std::map<std::string, std::string> landmarks;  ///< marker label → landmark name, or "ibug:36" (0 … 67)
  rig::MarkerPlaces places;                      ///< marker label → place; wins over a landmark of the same label
};

/// Reads {"anchors": {"LABEL": "8.1" | "ibug:36" | {"triangle": t, "barycentric": [a, b, c]} | {"landmark": …} |
/// {"vertex": v}, …}}; a file with "markers" instead (rig/markers.h) is taken as full places. Throws `InputError` naming
/// file and label.
Anchors read_anchors(const std::filesystem::path& file, const Topology& topology);

/// Anchors found without a file: marker labels that are themselves landmark names of the actor ("8.1", "ibug:36").
/// Empty when there are none.
Anchors anchors_by_name(const std::vector<std::string>& labels, const rig::Actor& actor);

/// Places of the anchors on the actor's topology. Throws `InputError` for an unknown landmark, with the nearest name.
rig::MarkerPlaces resolve(const Anchors& anchors, const rig::Actor& actor);

}  // namespace vultus::retarget
