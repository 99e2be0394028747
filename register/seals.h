#pragma once

#include <string>
#include <utility>
#include <vector>

#include "register/scan_surface.h"
#include "register/template.h"

namespace vultus::registration {

/// Rims are taken for sealed up to this `scan_gap`, mm: the widest groove that a scan shows between them.
inline constexpr double sealed_groove = 1.2;

/// How far two rims of skin that can touch stand apart, in the result and in the scan.
struct Seal {
  std::string name;                        ///< "lips", "left lids", "right lids"
  double mesh_gap = 0.0;                   ///< mm, mean over the pairs of the 68-point scheme
  double scan_gap = -1;                    ///< mm; -1 where the scan does not tell (coarse, no data)
  std::vector<std::pair<int, int>> pairs;  ///< vertices that touch when it is closed: the template's, or the scheme's
};

/// Looks at mouth and eyes of the template's 68-point scheme; nothing for a template without it.
///
/// The scan's lips stand open where it lies more than 3 mm behind both lips' fronts, or is missing, on lines from the
/// upper lip to the lower: between sealed lips it shows a groove no wider than a millimetre or so. Its lids stand open
/// between two steps of a lid's thickness seen from the eyeball's centre, down from the lower lid and up to the upper:
/// a closed eye has neither. `positions` are in the scan's frame, mm.
std::vector<Seal> find_seals(const Template& head, const Points& positions, const ScanSurface& scan);

}  // namespace vultus::registration
