#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/virtual_stage/mocap_volume.h"

namespace vultus::virtual_stage {

/// What a tracker gets wrong. A rate is a number of places in 10,000 frames.
struct FaultOptions {
  std::uint64_t seed = 1;
  double swaps = 22;      ///< two or three neighbours under each other's labels, ≥ 0
  double phantoms = 12;   ///< reflections: under the label of a marker that is hidden, or unlabelled, ≥ 0
  double fragments = 8;   ///< stretches of a marker delivered without its label, ≥ 0
  double slip_mm = 0.0;   ///< how far one target of the jig moves on the band, once; 0: none, ≤ 50
  double slip_at = 0.55;  ///< when, as a share of the take, 0 … 1

  void validate() const;  ///< throws `UsageError`
};

/// One place of a take where the tracker was wrong.
struct Fault {
  enum class Kind { swap, phantom, stray_phantom, fragment } kind = Kind::swap;
  int first = 0, last = 0;   ///< frames, both ends
  std::vector<int> markers;  ///< true numbers of those concerned; a swap moves each to the next one's label
};

/// A take as a tracker would deliver it, and who is who in it.
struct FaultyTake {
  static constexpr int nobody = -1;   ///< no sample
  static constexpr int phantom = -2;  ///< a sample of no marker
  mocap::Take take;         ///< the labels of `RecordedTake::take`, then unlabelled trajectories "*1", "*2", …
  std::vector<int> owners;  ///< frames × columns of `take`: the true marker, `nobody` or `phantom`
  std::vector<Fault> faults;
  int slipped_marker = -1, slip_first = 0, slip_last = 0;  ///< the jig's target that slips, and when
};

/// Puts the faults into a recorded take. Swaps begin where one of the markers comes back from a short absence, or
/// outright; they last 10 to 200 frames. The same arguments give the same bytes.
FaultyTake with_faults(const RecordedTake& recorded, int jig_markers, const FaultOptions& options);

/// How a repaired take stands against the truth.
struct LabelScore {
  std::size_t samples = 0, right = 0;  ///< all samples that the cameras gave; right: under their label,
                                       ///< and phantoms dropped
  std::size_t samples_in_swaps = 0, right_in_swaps = 0;  ///< those of the markers of each swap, in its frames
  int swaps_left = 0;                                    ///< swaps with a sample under the other's label
};

/// `repaired` has the frames of `faulty.take` and the recorded labels; a sample counts as right where the repaired take
/// has the very position under its true label.
LabelScore score_labels(const FaultyTake& faulty, const mocap::Take& repaired);

}  // namespace vultus::virtual_stage
