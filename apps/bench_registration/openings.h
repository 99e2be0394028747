#pragma once

#include <string>
#include <vector>

#include "apps/bench_registration/case_set.h"

namespace vultus::apps::bench {

/// How wide mouth and eyes stand open, truly and in a result: the mean distance of the rims over the pairs of the
/// 68-point scheme, mm.
struct Opening {
  std::string name;  ///< "mouth", "right eye", "left eye"
  double truly = 0.0, found = 0.0;
  /// Sealed (truly at most 1.5 mm: rims have a thickness) stays within 2 mm; open stays open by half at least.
  bool right() const { return truly <= 1.5 ? found <= 2.0 : found >= 0.5 * truly; }
};

/// Of a template with the 68-point scheme; nothing for any other. Both n×3 over the refined template, any frames.
std::vector<Opening> openings(const registration::Template& head, const Points& truth, const Points& found);

}  // namespace vultus::apps::bench
