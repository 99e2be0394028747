#pragma once

#include <vector>

#include "core/transform.h"
#include "register/mouth_gape.h"
#include "register/scan_surface.h"
#include "register/template.h"

namespace vultus::registration {

/// Where a gaping mouth has taken the jaw's skin.
struct GapingJaw {
  Similarity motion;       ///< rigid, from `rest`
  std::vector<int> front;  ///< vertices that follow it: from the lower lip's rim to the chin
  double mismatch = 0.0;   ///< mean distance of the moved front from the scan, mm, at most 6 each …
  double unmoved = 0.0;    ///< … and of the front at rest
};

/// The rigid motion that brings the front of the jaw in `rest` (refined topology, scan frame, mm) onto the scan while
/// its lip's rim comes to where the gape has its lower edge, which keeps the smooth chin from sliding; turns about
/// other axes than the one from ear to ear have to earn their place. Point-to-plane steps as in `align_surface` from
/// several turns, the best kept. No front comes back where the template names too little of jaw and lips, or where
/// none of it finds the scan.
GapingJaw find_gaping_jaw(const Template& head, const Topology& topology, const Points& rest,
                          const std::vector<bool>& fitted, const MouthGape& gape, const ScanSurface& scan);

}  // namespace vultus::registration
