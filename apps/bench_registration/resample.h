#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh.h"
#include "core/transform.h"

namespace vultus::apps::bench {

struct ResampleOptions {
  std::uint64_t seed = 1;
  int triangles = 520'000;      ///< aimed at, 1,000 … 10,000,000; what comes out is within a few per cent
  double noise = 0.1;           ///< standard deviation along the ray, mm, 0 … 5
  double holes = 0.02;          ///< share of the samples lost in round patches, 0 … 0.5
  double hole_radius = 6.0;     ///< of the largest patch, mm, > 0; the smallest has half of it
  double max_rotation = 0.349;  ///< of the head about each axis, radians, 0 … 3.2
  double max_shift = 50.0;      ///< of the head along each axis, mm, ≥ 0
  double neck = 30.0;           ///< mm of the surface left below the face

  void validate() const;  ///< throws `UsageError` naming the option out of range
};

struct ResampledScan {
  Mesh mesh;                         ///< scan frame, mm
  Similarity scan_from_surface;      ///< rigid
  std::vector<SurfacePoint> places;  ///< for each vertex the place on the surface that it saw
};

/// A scan of a surface (mm, +y up, looking along +z) whose vertices have nothing to do with the surface's own: rays of
/// a jittered grid, fanned out from the head's axis so that they meet cheeks, the underside of nose and chin and the
/// ears alike, each taken where it meets the surface first; neighbours in the grid are joined where they are near, over
/// slits as narrow as the sampling too, so that closed lips grow together as they do in real scans. `face` are the
/// vertices about which the fan is laid and the neck is cut. The same surface and options give the same scan, whatever
/// the thread count. Throws `InputError` when hardly a ray meets the surface.
ResampledScan resample(const Mesh& surface, const std::vector<int>& face, const ResampleOptions& options);

}  // namespace vultus::apps::bench
