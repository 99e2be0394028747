#pragma once

#include <string>
#include <vector>

#include "mocap/gaps.h"

namespace vultus::mocap {

/// A marker that was never captured (inner lips, Sánchez 2003 §5.2): it keeps its offset from its sibling in the local
/// surface coordinates there.
struct VirtualMarker {
  std::string label;
  Eigen::Vector3d neutral = Eigen::Vector3d::Zero();  ///< place in the reference frame, head coordinates, mm
  std::string sibling;                                ///< outer marker that carries it; empty: the nearest one
};

/// Adds the markers to a filled take, wherever the sibling and two of its neighbours are there. Local coordinates: the
/// sibling is the origin, the plane of its four nearest markers gives the normal, the nearest of them the direction.
/// The expected error is the 70 % quantile of the same construction tried on captured markers of the take. Throws
/// `InputError` for labels that are taken, unknown siblings or siblings missing in the reference frame.
void add_virtual_markers(Filled& filled, int reference_frame, const std::vector<VirtualMarker>& markers);

}  // namespace vultus::mocap
