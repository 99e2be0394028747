#pragma once

#include <Eigen/StdVector>
#include <array>
#include <optional>

#include "core/rays.h"
#include "register/template.h"

namespace vultus::registration {

/// A mouth that gapes, as the scan's shape alone shows it from the front.
struct MouthGape {
  std::array<Eigen::Vector3d, 3> upper, lower;  ///< on the lips' rims, at points 61 to 63 and 67 to 65; scan frame
};

/// Looks along lines down the scan's front, started from the upper lip of `rest`, the person's neutral with its skull
/// where the scan has it (refined topology, mm): an opening begins where the surface falls off behind the upper lip and
/// ends where a lower lip comes back. Needs no landmark of the scan. Nothing unless most lines see an opening that is
/// wider than `least` mm.
std::optional<MouthGape> find_gape(const Template& head, const Points& rest, const RayScene& rays, double least = 8.0);

}  // namespace vultus::registration
