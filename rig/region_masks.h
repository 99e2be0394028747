#pragma once

#include <string>
#include <vector>

#include "rig/actor.h"
#include "rig/segmentation.h"

namespace vultus::rig {

struct MaskOptions {
  int size = 512;         ///< texels a side of the mask image
  double blend_mm = 4.0;  ///< standard deviation of the Gaussian on the skin, mm; 0: hard borders
  void validate() const;  ///< throws `InputError`
};

/// Regions with their masks in texture space and over the vertices; both sum to one everywhere.
struct RegionMasks {
  std::vector<Region> regions;
  Image masks;  ///< one channel a region
};

/// Masks of a segmentation (Liu et al. 2011 §3.2.1): each region's texture-space triangles are rasterised, smoothed by
/// a Gaussian and normalized; vertex masks are sampled from the result and normalized again. The Gaussian stays within
/// a UV chart (normalized convolution over its texels), its width in texels following from that chart's texels per
/// millimetre, so that charts that are neighbours only on the texture do not mix. Across a seam the vertex takes the
/// mean of both sides, and the triangles beside the seam are bent to it, so that the masks are continuous on the skin.
/// Parts apart from the skin take the mask of the skin vertices they follow. Empty texels take their nearest
/// neighbour's masks. Names say where a region lies (rig/region_names.h).
RegionMasks region_masks(const Actor& actor, const Segmentation& segmentation, const MaskOptions& options = {});

/// One region "whole" of weight one: retargeting the face at large (Liu eq. 1).
RegionMasks whole_face(const Topology& topology, int size = 64);

/// Hand-painted masks instead (Liu §6.1): channels are regions, values ≥ 0; normalized where they do not sum to one.
/// Throws `InputError` where the skin has no paint, naming a texel.
RegionMasks painted_masks(const Topology& topology, const Image& paint);

/// Segments the actor's face and gives it regions and masks. `regions == 1` makes "whole".
void divide_face(Actor& actor, const SegmentationOptions& segmentation = {}, const MaskOptions& masks = {});

}  // namespace vultus::rig
