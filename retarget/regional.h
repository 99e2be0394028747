#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/progress.h"
#include "mocap/take.h"
#include "retarget/marker_basis.h"
#include "retarget/marker_weights.h"
#include "retarget/weights.h"

namespace vultus::retarget {

/// With `marker_floor` and `rest_cost` at 0 this is the published problem; few markers a region and many poses then leave
/// weights open. The defaults settle them: on two real takes (41 markers, 58 poses, 6 regions) they raise the mean error
/// by 1 %, lower that of markers left out of the solve by 1 % and the weights' jitter by 7 and 19 %.
struct SolveOptions {
  /// Every marker counts at least this much in every region, so that a region whose own markers leave some weights open
  /// follows the rest of the face there. [0, 1].
  double marker_floor = 0.03;
  /// Cost of weight away from the neutral, mm² a unit of weight: a pose that moves no marker of a region gets no weight
  /// there, and of two ways to reach the same markers the smaller motion wins. ≥ 0.
  double rest_cost = 0.2;
  /// Standard deviation of the Gaussian over time that Liu §7 smooths weights with, s; 0 leaves frames independent.
  double smoothing = 0.0;

  void validate() const;  ///< throws `InputError`
};

struct SolveResult {
  Weights weights;                          ///< frames × regions × poses of the basis
  std::vector<std::uint8_t> bridged;        ///< frames × regions: 1 where no marker of the region was seen, so that its
                                            ///< weights come from the nearest frames before and after
  double worst_kkt_residual = 0.0;          ///< over all frames and regions; exact solutions stay below 1e-9
  long iterations = 0;                      ///< of the active set, all frames and regions together
  std::vector<std::string> notes;           ///< markers without a trajectory, regions without markers
};

/// Liu et al. 2011 eq. 1 and 2 for a whole take, exactly: for each frame and region the weights ≥ 0 with sum one that
/// minimize |M_k S w − M_k t|² + rest_cost · (1 − w_neutral). Markers missing in a frame count nothing there. Positions
/// are taken relative to the neutral column of S, which Σw = 1 makes the same problem. `take` and `basis` share one
/// space; `weights` has the basis's labels, in any order. A region that never sees a marker stays neutral. Frames are
/// independent, so the result depends neither on threads nor on how a take is split. Throws `InputError` when no marker
/// of the basis is in the take.
SolveResult solve_take(const mocap::Take& take, const MarkerBasis& basis, const MarkerWeights& weights,
                       const SolveOptions& options = {}, Progress& progress = Progress::none());

/// Gaussian filter over time, cut at 4 deviations and renormalized at the ends of the take: rows stay ≥ 0 and sum to
/// one. `deviation` in seconds.
void smooth(Weights& weights, double deviation);

}  // namespace vultus::retarget
