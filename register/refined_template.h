#pragma once

#include <vector>

#include "register/subdivide.h"
#include "register/template.h"

namespace vultus::registration {

/// A template and what every scan registered to it shares: its refined surface and which of its skin is fitted.
struct RefinedTemplate {
  Template head;
  LoopSubdivision loop;
  Points neutral;                    ///< of the refined topology, mm
  std::vector<bool> fitted;          ///< refined vertices that a scan shows (`exposed_vertices`)
  std::vector<bool> fitted_control;  ///< the same of the control mesh
  explicit RefinedTemplate(Template given);

  const Topology& topology() const { return *loop.refined(); }
  /// Skin that expressions leave alone most: the set "rigid", else everything fitted.
  std::vector<int> rigid() const;
  /// Fitted skin that the jaw does not move: above the base of the nose; everything fitted without a 68-point scheme.
  std::vector<int> above_lips() const;
};

}  // namespace vultus::registration
