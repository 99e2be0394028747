#pragma once

#include <optional>
#include <vector>

#include "core/mesh.h"
#include "mocap/gaps.h"
#include "mocap/take_view.h"

namespace vultus::mocap {

/// What a method puts into a gap.
struct Guess {
  Points places;          ///< one row a frame of the gap, mm
  Eigen::VectorXd scale;  ///< one a frame: the method's own idea of its error; only ratios matter
};

/// Cubic Hermite curve over the gap; the velocities at its ends are those of parabolas fitted to up to `window`
/// samples beside it (≥ 2). A gap at the take's edge holds the nearest sample. Rows are the gap's frames, mm; nothing
/// when the marker is never seen beside the gap.
std::optional<Points> spline_fill(const TakeView& view, const Gap& gap, int window = 5);

/// For each marker, the others in the order in which they suit to carry it: those whose distance to it changes least
/// first (robust deviation, mm), near ones before far ones.
class RigidGroups {
 public:
  explicit RigidGroups(const Take& take);
  struct Neighbour {
    int marker;
    double deviation;  ///< of the distance, mm
    double distance;   ///< typical, mm
  };
  const std::vector<Neighbour>& of(int marker) const { return neighbours_[static_cast<std::size_t>(marker)]; }

 private:
  std::vector<std::vector<Neighbour>> neighbours_;
};

/// The marker carried by the rigid motion of its group (Sánchez 2003 §5.2) from the sample before the gap and from the
/// one after it, blended in time. Nothing when a frame of the gap has fewer than three neighbours in common with both
/// ends, or they are collinear.
std::optional<Points> rigid_group_fill(const TakeView& view, const Gap& gap, const RigidGroups& groups, int group_size);

}  // namespace vultus::mocap
