#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "apps/virtual_stage/face_model.h"

namespace vultus::virtual_stage {

/// Markers as glued on an actor: half-spheres on the skin and a band with targets on the skull.
struct MarkerLayout {
  std::vector<std::string> labels;             ///< 97 face markers
  std::vector<SurfacePoint> places;            ///< of their bases, on the actor's subdivided topology
  std::map<std::string, std::string> anchors;  ///< label → template landmark, for the markers put exactly on one
  std::vector<std::string> jig_labels;         ///< JIG1 … JIG5
  Points jig;                                  ///< 5×3, face frame, mm
};

/// 13 markers on the midline and 42 a side: forehead, brows, temples, under the eyes, nose, cheeks, lips' outer border,
/// chin and jaw; none on lids or inside the mouth. L and R are the subject's. Those that are not anchors sit where a
/// hand put them, up to about a millimetre off their plan.
MarkerLayout marker_layout(const FaceModel& actor, std::uint64_t seed);

constexpr double marker_radius = 1.5;  ///< mm from skin to a marker's centre

/// Marker centres on a posed face (97×3, mm).
Points marker_positions(const MarkerLayout& layout, const Topology& topology, const Points& posed);

}  // namespace vultus::virtual_stage
