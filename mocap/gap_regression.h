#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/mesh.h"
#include "mocap/gap_methods.h"
#include "mocap/gap_trials.h"
#include "mocap/take_view.h"

namespace vultus::mocap {

/// Covariance of a marker's motion between two frames, relative to the marker's own variance. The other markers' pose
/// enters as one vector z of mean square length one, near markers counting more, lively ones less.
struct RegressionKernel {
  double reach = 40.0;           ///< mm; weight of an input marker falls by e over this distance
  double liveliness = 0.6;       ///< inputs are divided by this power of their own deviation, 0…1
  double linear = 3.0;           ///< deviation of the part linear in z
  double similar = 5.0;          ///< deviation of the part that depends on |z - z'| (rational quadratic)
  double similar_length = 0.8;   ///< its length in z
  double similar_seconds = 8.0;  ///< and in time (Matérn 5/2)
  double smooth = 0.6;           ///< deviation of the part that is only smooth in time
  double smooth_seconds = 0.3;   ///< its time (Matérn 5/2)
  double noise = 1.0;            ///< white, times the marker's own jitter
};

/// A kernel with its parts in time tabulated by the distance in frames.
struct PreparedKernel {
  RegressionKernel kernel;
  std::vector<double> similar_in_time, smooth_in_time;
};

/// Fills a gap by Gaussian-process regression on the visible markers and on time (Rasmussen and Williams 2006, ch. 2),
/// learned from the same take: the frames beside the gap and others spread over the take.
class GapRegression {
 public:
  /// `measured` is the take in head coordinates, `guess` the same with gaps filled in a first pass; inputs come from
  /// the guess, what is learned only from measured samples. Both must outlive the object. `spread` frames are used
  /// beside those near the gap.
  GapRegression(const Take& measured, const Take& guess, int spread);

  /// Nothing when fewer than four other markers can be relied on during the gap or the marker is hardly ever seen.
  /// `scale` of the result is the posterior deviation, mm.
  std::optional<Guess> fill(const TakeView& view, const Gap& gap, const PreparedKernel& prepared) const;

  PreparedKernel prepared(const RegressionKernel& kernel) const;

  /// The kernel among several that does best on gaps of `length` frames cut into the take's visible samples.
  RegressionKernel fitted(const RigidGroups& groups, int length, std::uint64_t seed) const;

 private:
  double error_on(const std::vector<GapTrial>& trials, const RegressionKernel& kernel) const;
  std::vector<int> inputs_for(const TakeView& view, const Gap& gap) const;
  std::vector<int> frames_for(const TakeView& view, const Gap& gap, const std::vector<int>& inputs) const;

  const Take &measured_, &guess_;
  int spread_;
  Points centres_;              // markers×3, mean positions, mm
  Eigen::VectorXd deviations_;  // markers, mm
  Eigen::VectorXd jitters_;     // markers, mm, white noise of a coordinate
};

}  // namespace vultus::mocap
