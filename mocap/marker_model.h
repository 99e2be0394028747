#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "mocap/take.h"

namespace vultus::mocap {

/// Where each marker of a face should be, given where the others are: every neighbour makes its own prediction by a
/// linear map learned from the take, and the weighted median of them counts, so that a neighbour under a wrong label
/// does no harm.
class MarkerModel {
 public:
  /// `take` in head coordinates; the first `markers` columns are learned from up to 600 of `frames`, with trimming, so
  /// that a few wrong labels in a hundred do no harm.
  MarkerModel(const Take& take, int markers, const std::vector<int>& frames);

  int markers() const { return static_cast<int>(links_.size()); }
  /// Marker `m` in `frame` of `take` (same columns, head coordinates); nothing when fewer than two neighbours are seen.
  std::optional<Eigen::Vector3d> predicted(const Take& take, int frame, int m) const;
  /// Typical miss of the prediction, mm (70 % quantile over the frames learned from); infinite for a marker hardly
  /// seen.
  double scatter(int m) const { return scatter_[static_cast<std::size_t>(m)]; }
  const Eigen::Vector3d& mean(int m) const { return means_[static_cast<std::size_t>(m)]; }

 private:
  struct Link {
    int neighbour;
    Eigen::Matrix3d map;     // marker's offset from its mean, from the neighbour's
    Eigen::Vector3d offset;  // mm
    double weight;           // 1/mm²
  };
  std::optional<Link> link(const Take& take, const std::vector<int>& frames, int marker, int neighbour) const;

  std::vector<Eigen::Vector3d> means_;
  std::vector<std::vector<Link>> links_;
  std::vector<double> scatter_;
};

}  // namespace vultus::mocap
