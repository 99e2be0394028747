#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "mocap/rigid_body.h"

namespace vultus::mocap {

/// Where every labelled marker of a take is on the head, and how far it strays from there: in head coordinates, medians
/// over the take; a take of fewer than 30 frames (a neutral layout) is taken as it is in its most complete frame.
/// Throws `InputError` for takes with fewer than eight labelled markers.
RigidBody marker_layout(const Take& labelled);

/// A layout laid over the unlabelled points of one frame.
struct LayoutFit {
  Similarity world_from_layout;  ///< rigid
  std::vector<int> points;       ///< for each marker of the layout the point that it is, -1: none
  int matched = 0;
};

/// For each marker how far a point may be from its place and still be it, mm: most of the way to its neighbour.
Eigen::VectorXd gates(const RigidBody& layout);

/// The rigid motion that brings most markers near to points: triples of steady, spread markers against all triples of
/// points with the same distances (Fischler and Bolles 1981; seeded, so repeatable), then `match_layout`. Nothing when
/// no triple fits. `points` N×3, mm.
std::optional<LayoutFit> align_layout(const RigidBody& layout, const Points& points);

/// One-to-one matches under `start` (least sum of squares within the gates), refined in turn with the motion; a marker
/// is expected where the motion and its neighbours' common displacement (of an expression) put it. `known` holds
/// matches to begin with, -1 for none, or is empty.
std::optional<LayoutFit> match_layout(const RigidBody& layout, const Points& points, const Similarity& start,
                                      const std::vector<int>& known = {});

}  // namespace vultus::mocap
