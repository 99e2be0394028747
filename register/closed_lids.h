#pragma once

#include <string>
#include <vector>

#include "register/graph_fit.h"
#include "register/scan_surface.h"
#include "register/template.h"

namespace vultus::registration {

/// Lids that the scan shows closed where the rest shape has them open, and the way their skin has to go.
struct LidClosing {
  std::vector<std::string> lids;  ///< "right lids", "left lids"; empty where nothing closes
  std::vector<PointTerm> terms;   ///< skin of those lids to where closing takes it
};

/// A closing lid slides farther than surfaces are matched, and its landmarks are hidden: this is where it starts. Rims
/// turn about the eyeball's middle to a line near the lower one, since the upper lid does most of the way (Evinger,
/// Manning & Sibony 1991); the skin beyond comes along less and less. `rest` is the open shape in the scan's frame, mm.
LidClosing find_lid_closing(const Template& head, const std::vector<bool>& fitted, const Points& rest,
                            const ScanSurface& scan);

}  // namespace vultus::registration
