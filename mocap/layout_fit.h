#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "mocap/rigid_body.h"

namespace vultus::mocap {

/// Where every labelled marker of a take is on the head, and how far it strays from there: in head coordinates, medians
/// over the take; a take of fewer than 30 frames (a neutral layout) is taken as it is in its most complete frame.
/// Labels far from the others there (lost markers written as (0, 0, 0)) are left out.
/// Throws `InputError` for takes with fewer than eight labelled markers.
RigidBody marker_layout(const Take& labelled);

/// A layout laid over the unlabelled points of one frame.
struct LayoutFit {
  Similarity world_from_layout;  ///< rigid
  std::vector<int> points;       ///< for each marker of the layout the point that it is, -1: none
  int matched = 0;
  /// How badly it fits, in markers: the sum of (distance / gate)² of those that are matched, 1 for each that is not.
  double cost = 0.0;
  /// Cost of the best fit in a clearly different pose, infinite when no other was found: a layout that is nearly
  /// symmetric fits the wrong way round about as well.
  double rival_cost = std::numeric_limits<double>::infinity();
  double margin() const { return rival_cost - cost; }  ///< how many markers speak for it
};

/// For each marker how far a point may be from its place and still be it, mm: most of the way to its neighbour.
Eigen::VectorXd gates(const RigidBody& layout);

/// The rigid motion that brings most markers near to points: triples of steady, spread markers against all triples of
/// points with the same distances (Fischler and Bolles 1981; seeded, so repeatable), then `match_layout` for the best
/// of each pose; the least cost wins, the next is its rival. Nothing when no triple fits. `points` N×3, mm.
std::optional<LayoutFit> align_layout(const RigidBody& layout, const Points& points);

/// One-to-one matches under `start` (least sum of squares within the gates), refined in turn with the motion; a marker
/// is expected where the motion and its neighbours' common displacement (of an expression) put it. `known` holds
/// matches to begin with, -1 for none, or is empty.
std::optional<LayoutFit> match_layout(const RigidBody& layout, const Points& points, const Similarity& start,
                                      const std::vector<int>& known = {});

}  // namespace vultus::mocap
