#pragma once

#include "mocap/rigid_body.h"

namespace vultus::mocap {

/// Frames spread evenly over the take in which at least half of its most complete frame's markers are seen.
std::vector<int> sampled_frames(const Take& take, int at_most);

/// The sampled frame nearest to all others (least median distance of its markers after rigid alignment): a plain,
/// complete, neutral-like frame to refer to.
int central_frame(const Take& take, const std::vector<int>& columns);

/// The markers of a face that move least against each other, for takes without a jig: of many triples of markers, each
/// taken as the head, the one that leaves the steadiest half of all markers at rest is refined by re-weighted
/// Procrustes analysis; markers that stray more than `tolerance` times the steadiest quarter are left out (six stay at
/// least). Deterministic. Throws `InputError` for takes with fewer than six usable markers.
RigidBody find_steady_markers(const Take& take, int reference_frame, double tolerance = 3.0);

}  // namespace vultus::mocap
