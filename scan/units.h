#pragma once

#include <string>

#include "core/mesh.h"

namespace vultus::scan {

/// The unit of a head's or face's coordinates.
struct Units {
  std::string name = "mm";
  double mm_per_unit = 1.0;
  bool certain = true;   ///< false when no unit makes it a head; mm_per_unit is then 1
  bool guessed = false;  ///< from the size rather than told
};

/// From the size of the middle 98 % of the finite points: 12 cm (a cropped face) to 1.2 m (a bust, two people) when
/// read in millimetres, centimetres, metres, micrometres or inches, the first that fits. Throws `InputError` without a
/// finite point.
Units guess_units(const Points& positions);

}  // namespace vultus::scan
