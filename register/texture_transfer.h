#pragma once

#include "core/image.h"
#include "core/mesh.h"

namespace vultus::registration {

struct ColourTransferOptions {
  int size = 1024;               ///< texels a side, 16 … 16384
  double farthest = 2.0;         ///< mm between the registered surface and the scan, > 0; farther texels count as unseen
  double least_agreement = 0.3;  ///< cosine between both normals, in (-1, 1); less counts as unseen
  void validate() const;         ///< throws `InputError`
};

/// True when a scan carries colour: per vertex, or a texture image that can be opened.
bool has_colour(const Mesh& scan);

/// The scan's colour in the registered mesh's texture space, linear RGB, size×size, gutters filled.
/// `scan` is in the frame of `registered`, mm. A texel takes the colour of the closest point of the scan where that is
/// near and faces the same way. Unseen texels of skin are filled smoothly from their neighbours on the surface; sets
/// that scans show only by chance and out of place (eyeball…, inner_mouth…, teeth…, gums…) keep `unseen`
/// (vertex_count×3 linear RGB). Throws `InputError` without UVs or colour.
Image transfer_colours(const Mesh& registered, const Mesh& scan, const Points& unseen,
                       const ColourTransferOptions& options = {});

}  // namespace vultus::registration
