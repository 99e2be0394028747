#pragma once

#include <string>
#include <vector>

#include "apps/bench_registration/case_set.h"
#include "register/registered.h"
#include "scan/clean.h"

namespace vultus::apps::bench {

/// How far one result is from the truth; mm.
struct Distances {
  std::vector<float> surface;  ///< from places spread evenly over the true surface to the registered skin
  std::vector<float> vertex;   ///< of the measured vertices to where they should be, in the order of their numbers
};

/// `mm_per_unit` is what cleaning multiplied the scan by. Where the registered surface is measured, its hidden parts
/// (mouth cavity, eyeballs, teeth) are left out.
Distances measure(const Truth& truth, const registration::Registered& registered, const std::vector<bool>& measured,
                  double mm_per_unit);

/// From the vertices of the cleaned scan (noise and all) to the registered skin, mm: those that no invented triangle
/// has, whose nearest place on the skin is in a measured triangle, and not farther than `data_within`, beyond which a
/// scan shows something else (hair, clothes).
std::vector<float> scan_distances(const scan::CleanScan& cleaned, const registration::Registered& registered,
                                  const std::vector<bool>& measured, double data_within = 5.0);

/// Of a result's vertices of the 68-point scheme to the places where others put these points, mm; empty for a template
/// without the scheme.
std::vector<float> landmark_distances(const registration::Template& head, const registration::Registered& registered,
                                      const PlacedLandmarks& placed, double mm_per_unit);

/// The result's vertices in the frame of the raw scan.
Points in_scan_frame(const registration::Registered& registered, double mm_per_unit);

/// `count` places evenly at random over the given triangles; the same for the same seed.
Points surface_places(const Mesh& surface, const std::vector<int>& triangles, int count, std::uint64_t seed);

}  // namespace vultus::apps::bench
