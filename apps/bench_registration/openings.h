#pragma once

#include <string>
#include <vector>

#include "apps/bench_registration/case_set.h"

namespace vultus::apps::bench {

/// How wide lips and lids stand open, truly and in a result: the mean distance over the pairs of vertices that touch
/// when they are closed, mm.
struct Opening {
  std::string name;  ///< "lips", "right lids", "left lids"
  double truly = 0.0, found = 0.0;
  double thickness = 0.0;  ///< mm by which the pairs stand apart even then
  /// Sealed (within a millimetre) stays sealed; open stays open by half at least.
  bool right() const { return truly <= thickness + 1.0 ? found <= thickness + 1.0 : found >= 0.5 * truly; }
};

/// By the template's own touching rims or, where it has none, by the inner points of the 68-point scheme; nothing for a
/// template without either. Both n×3 over the refined template, any frames.
std::vector<Opening> openings(const registration::Template& head, const Points& truth, const Points& found);

}  // namespace vultus::apps::bench
