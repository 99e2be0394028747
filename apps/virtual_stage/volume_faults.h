#pragma once

#include <cstdint>
#include <vector>

#include "apps/virtual_stage/mocap_volume.h"

namespace vultus::virtual_stage {

/// What a tracker gets wrong. A rate is a number of places in 10,000 frames, 0 … 1000.
struct FaultOptions {
  std::uint64_t seed = 1;
  double swaps = 22;      ///< two or three neighbours under each other's labels
  double phantoms = 12;   ///< reflections: under the label of a marker that is hidden, or unlabelled
  double fragments = 8;   ///< stretches of a marker delivered without its label
  double spikes = 0;      ///< a marker leaps 3 to 30 mm away for one or two frames
  double dropouts = 0;    ///< a lost marker is written as (0, 0, 0) for up to 20 frames
  double held = 0;        ///< up to four lost frames are written as the one before them
  double slip_mm = 0.0;   ///< how far one target of the jig moves on the band, once; 0: none, ≤ 50
  double slip_at = 0.55;  ///< when, as a share of the take, 0 … 1

  void validate() const;  ///< throws `UsageError`
};

/// One place of a take where the tracker was wrong.
struct Fault {
  enum class Kind { swap, phantom, stray_phantom, fragment, spike, dropout, held } kind = Kind::swap;
  int first = 0, last = 0;   ///< frames, both ends
  std::vector<int> markers;  ///< true numbers of those concerned; a swap moves each to the next one's label
  int column = -1;           ///< of the take, where unlabelled samples stand
  double size = 0.0;         ///< mm, of a spike
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

}  // namespace vultus::virtual_stage
