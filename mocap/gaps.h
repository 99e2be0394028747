#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mocap/take.h"

namespace vultus::mocap {

/// A stretch in which a marker is missing, frames `first` to `last` with both ends.
struct Gap {
  int marker = 0, first = 0, last = 0;
  Origin method = Origin::missing;  ///< missing: left a hole
  double expected_error = 0.0;      ///< mm, the largest over the gap; 0 for holes
  int frames() const { return last - first + 1; }
};

/// Every gap, by marker and then by frame.
std::vector<Gap> find_gaps(const Take& take);

enum class GapMethod {
  automatic,    ///< for each length of gap what does best on the take itself, else the next in this list
  low_rank,     ///< Gaussian-process regression on the visible markers and on time, learned from the take
  rigid_group,  ///< rigid motion of a group of neighbours (Sánchez 2003 §5.2)
  spline,       ///< cubic splines only; longer gaps stay holes
};

struct FillOptions {
  GapMethod method = GapMethod::automatic;
  double spline_seconds = 0.2;  ///< gaps up to this long are bridged by splines, ≥ 0
  int group_size = 6;           ///< markers of a rigid group at most, 3 to 32
  double hole_above_mm = 4.0;   ///< gaps with a larger expected error stay holes, > 0
  int trials = 160;             ///< leave-out trials for each method and gap length, ≥ 20
  std::uint64_t seed = 1;       ///< of the trials
  void validate() const;        ///< throws `UsageError`
};

/// A take whose gaps are filled as far as that is honest.
struct Filled {
  Take take;
  std::vector<Origin> origins;         ///< frames × markers
  std::vector<float> expected_errors;  ///< frames × markers, mm; 0 for measured samples and holes
  std::vector<Gap> gaps;               ///< as found, with what was done
  std::vector<std::string> decisions;
};

/// Fills the gaps of a take in head coordinates: short ones by cubic splines with end velocities fitted to the samples
/// beside the gap, others by regression on the visible markers or by the rigid motion of a group of neighbours
/// (Sánchez 2003 §5.2) tied to the samples at the gap's ends. About 70 % of the true samples lie within the expected
/// error, which comes from gaps of the same kinds cut into the take's own visible samples. Gaps without enough
/// neighbours stay holes.
Filled fill_gaps(Take take, const FillOptions& options = {});

}  // namespace vultus::mocap
