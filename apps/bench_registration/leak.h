#pragma once

#include "apps/bench_registration/case_set.h"

namespace vultus::apps::bench {

/// Whether a test scan gives its answer away by having vertices where the template's are: mm, medians over the measured
/// vertices of their distance to the nearest vertex of the scan, and of the same distance of a random place in one of
/// the vertex's own triangles, which is what chance gives at the same density. A ratio well below one is a leak.
struct Leak {
  double to_vertices = 0.0, by_chance = 0.0;
  double covered = 0.0;  ///< share of the measured vertices that have a vertex of the scan within 1.5 mm
  double ratio() const { return to_vertices / by_chance; }
};
Leak leak(const Truth& truth, const Topology& refined, const std::vector<bool>& measured, const Points& scan);

}  // namespace vultus::apps::bench
