#pragma once

#include <vector>

#include "core/mesh.h"
#include "register/template_layout.h"

namespace vultus::registration::layout {

/// Texture layout: rows of `uvs` in [0, 1]², and for each triangle corner (three a triangle, in order) its row.
struct TextureLayout {
  Uvs uvs;
  std::vector<int> corner;
};

/// One chart for the skin, cut along the back midline from the neck to the crown, with the face given the most room,
/// and small charts below it for eyeballs, mouth cavity and teeth. No two triangles overlap and none is flipped: the
/// charts are `convex_map`s over convex outlines, then `relaxed_map`s.
TextureLayout texture_layout(const Weave& whole, const Points& positions);

}  // namespace vultus::registration::layout
