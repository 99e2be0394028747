#pragma once

#include <string>
#include <vector>

#include "core/mesh.h"
#include "register/template.h"

namespace vultus::rig {

/// ICT-FaceKit's light topology: its parts by vertex ranges, and what follows from them.
constexpr int ict_vertex_count = 26719;

/// Vertex sets of the parts, of landmarks' contours (lips, lids) and of `rigid`. `positions` in mm.
VertexSets ict_vertex_sets(const Topology& topology, const Points& positions, const registration::Ibug68& ibug68,
                           std::vector<int> rigid);

/// UVs with each part's tile in a place of its own.
void lay_out_ict_uvs(TopologyData& data);

/// MPEG-4 feature points at the 68-point scheme's vertices.
std::vector<registration::Landmark> mpeg4_landmarks(const registration::Ibug68& ibug68);

/// ARKit name and FACS units of an expression of the model; the name itself where it is unknown.
std::vector<std::string> ict_pose_tags(const std::string& pose);

}  // namespace vultus::rig
