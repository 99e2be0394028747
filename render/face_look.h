#pragma once

#include <vector>

#include "core/mesh.h"
#include "render/scene.h"

namespace vultus::render {

/// What a head looks like as far as the names of its vertex sets tell: "lips" redder and glossier with a soft edge;
/// "eyeball…" white with an iris and a pupil about +z, under a wet coat; "teeth…"; "gums…", "tongue…", "inner_mouth…",
/// "mouth_cavity…" and "mouth_socket…"; "lacrimal…"; everything else skin. Sets that need transparency are hidden:
/// "eyelashes…" drawn on strips, and a game engine's "eye_occlusion…" and "eye_blend…".
struct FaceLook {
  Points colours;                ///< vertex_count×3 linear reflectance
  std::vector<Finish> finishes;  ///< one a vertex
  std::vector<int> hidden_vertices;
};

/// `neutral`: vertex_count×3, mm, in the face frame of DESIGN §1.
FaceLook face_look(const Topology& topology, const Points& neutral);

}  // namespace vultus::render
