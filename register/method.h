#pragma once

#include <memory>
#include <string>
#include <vector>

#include "register/anchors.h"
#include "register/prepare.h"
#include "register/refined_template.h"
#include "register/register_options.h"
#include "register/registered.h"
#include "register/scan_surface.h"

namespace vultus::registration {

/// What every method of registration is given.
struct FitInput {
  const RefinedTemplate& model;
  const Preparation& preparation;
  const Prepared& prepared;
  const ScanSurface& scan;  ///< of `prepared.scan`
  const RegisterOptions& options;
};

/// What every method answers.
struct Fit {
  Points positions;                    ///< refined topology, scan frame, mm
  Anchors anchors;                     ///< landmarks that took part
  Similarity face_from_scan;           ///< of the prepared scan
  std::vector<std::string> decisions;  ///< in words
  std::shared_ptr<const Appearance> look;  ///< of a neutral's scan, where expressions are compared with it; else null
};

/// Anchors of a scan against the template; throws `InputError` when too few can be trusted.
Anchors template_anchors(const FitInput& input);

/// Face frame of a fitted pose by its eyes and nose ridge (Zhu §4.7), or, where the template names none, by robust
/// rigid alignment with `reference` (refined topology).
Similarity upright(const Template& head, const Points& positions, const Points& reference);

}  // namespace vultus::registration
