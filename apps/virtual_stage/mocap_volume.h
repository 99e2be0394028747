#pragma once

#include <cstdint>
#include <vector>

#include "apps/virtual_stage/marker_layout.h"
#include "apps/virtual_stage/performances.h"
#include "core/transform.h"
#include "mocap/take.h"

namespace vultus::virtual_stage {

struct VolumeOptions {
  std::uint64_t seed = 1;
  double noise = 0.1;        ///< standard deviation of each coordinate, mm, ≥ 0
  double missing = 0.02;     ///< fraction of the face markers' samples lost in bursts, 0 … 0.5
  double head_motion = 1.0;  ///< 1: up to about 20° and 40 mm; 0: a head clamped in place

  void validate() const;  ///< throws `UsageError` naming the option out of range
};

/// A recorded take beside its truth.
struct RecordedTake {
  mocap::Take take;                          ///< 97 face and 5 jig markers in the volume, +y up, as cameras gave them
  mocap::Take clean;                         ///< the same markers in the face frame: no head motion, noise or gaps
  std::vector<Similarity> volume_from_face;  ///< the head's pose in each frame, rigid
};

/// Records a performance in a marker volume. Gaps come in bursts of 3 to 40 frames, more often where a marker faces
/// away from the cameras in front, and make up the asked share exactly (to a burst); jig markers lose a tenth of that.
/// The same arguments give the same bytes.
RecordedTake record(const FaceModel& actor, const MarkerLayout& layout, const Performance& performance,
                    const VolumeOptions& options);

/// Fraction of samples missing over the markers [first, last) of a take.
double missing_share(const mocap::Take& take, int first, int last);

}  // namespace vultus::virtual_stage
