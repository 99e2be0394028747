#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh.h"
#include "core/transform.h"

namespace vultus::virtual_stage {

/// What stands in front of the scanner.
struct ScanSubject {
  Mesh surface;          ///< the true surface in the face frame, mm; colours are its albedo, where it has them
  Eigen::VectorXd hair;  ///< vertex_count, 0 (skin) … 1 (hair, which scanners see badly); empty for none
};

struct ScanOptions {
  std::uint64_t seed = 1;
  int triangles = 220'000;      ///< aimed at, 1,000 … 10,000,000; what comes out is within a few per cent
  double noise = 0.07;          ///< standard deviation along the sensor's ray, mm, ≥ 0; ten times that in hair
  double spikes = 2e-4;         ///< fraction of samples that are off by millimetres, 0 … 0.1
  double dropout = 0.004;       ///< fraction of the surface lost in random patches, 0 … 0.5
  bool clutter = true;          ///< strands of hair, bits of shoulder and stand, flying points
  double max_rotation = 0.26;   ///< of the head about each axis, radians, 0 … 0.8
  double max_translation = 30;  ///< of the head along each axis, mm, 0 … 150

  void validate() const;  ///< throws `UsageError` naming the option out of range
};

struct Scan {
  Mesh mesh;                        ///< scan frame, mm; own triangulation, coloured where the subject is
  Similarity scan_from_face;        ///< the head's pose, rigid
  std::vector<SurfacePoint> truth;  ///< for each vertex the place on the subject it saw; invalid for clutter
};

/// A structured-light scan: ten sensor heads around the chair, each with its projector beside it, cast jittered grids
/// of rays at the subject. A place counts where camera and projector both see it at less than 75° from its normal, and
/// is measured by the sensor that sees it most frontally; the others' samples of it are left out. The merged points are
/// triangulated by advancing front (Cohen-Steiner and Da 2004, CGAL), which bridges gaps as narrow as the sampling (so
/// closed lips and lids grow together, as in real scans) and leaves holes where nothing was seen: nostrils, under the
/// chin, behind the ears, patches of hair.
/// The same subject and options give the same bytes. Throws `InputError` for a subject that no sensor sees.
Scan scan_subject(const ScanSubject& subject, const ScanOptions& options);

}  // namespace vultus::virtual_stage
