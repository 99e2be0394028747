#include "retarget/marker_map.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/LU>
#include <fmt/format.h>

#include "core/error.h"
#include "core/neighbours.h"
#include "core/rays.h"

namespace vultus::retarget {
namespace {

/// The part of the rig markers may sit on.
class FaceSurface {
 public:
  FaceSurface(const rig::Actor& actor, const std::string& set) : triangle_(triangles_of(*actor.topology, set)) {
    Triangles kept(static_cast<Eigen::Index>(triangle_.size()), 3);
    for (Eigen::Index i = 0; i < kept.rows(); ++i) kept.row(i) = actor.topology->triangles().row(triangle_[i]);
    scene_.emplace(*Topology::from_triangles(actor.topology->vertex_count(), kept), actor.neutral());
  }

  /// The nearest place on the whole topology; invalid beyond `max_distance`.
  SurfacePoint closest(const Eigen::Vector3d& point, double max_distance) const {
    const auto found = scene_->closest(point, max_distance);
    if (!found) return {};
    return {triangle_[found->place.triangle], found->place.barycentric};
  }

 private:
  static std::vector<int> triangles_of(const Topology& topology, const std::string& set) {
    std::vector<bool> keep(topology.vertex_count(), !topology.has_set(set));
    if (topology.has_set(set)) {
      for (int vertex : topology.set(set)) keep[vertex] = true;
    }
    std::vector<int> result;
    const Triangles& triangles = topology.triangles();
    for (int t = 0; t < triangles.rows(); ++t) {
      if (keep[triangles(t, 0)] && keep[triangles(t, 1)] && keep[triangles(t, 2)]) result.push_back(t);
    }
    if (result.empty()) throw InputError("vertex set \"" + set + "\" holds no triangle to place markers on");
    return result;
  }

  std::vector<int> triangle_;  // number in the whole topology of each triangle of the scene
  std::optional<RayScene> scene_;
};

struct AnchorPairs {
  std::vector<std::string> labels;
  Points mocap, rig;
};

AnchorPairs pair_anchors(const std::vector<std::string>& labels, const Points& neutral,
                         const rig::MarkerPlaces& anchors, const rig::Actor& actor) {
  AnchorPairs pairs;
  pairs.mocap.resize(static_cast<Eigen::Index>(labels.size()), 3);
  pairs.rig.resize(static_cast<Eigen::Index>(labels.size()), 3);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const auto anchor = anchors.find(labels[i]);
    if (anchor == anchors.end() || !neutral.row(i).allFinite()) continue;
    const auto row = static_cast<Eigen::Index>(pairs.labels.size());
    pairs.mocap.row(row) = neutral.row(i);
    pairs.rig.row(row) = position_of(anchor->second, *actor.topology, actor.neutral()).transpose();
    pairs.labels.push_back(labels[i]);
  }
  const auto count = static_cast<Eigen::Index>(pairs.labels.size());
  pairs.mocap.conservativeResize(count, 3);
  pairs.rig.conservativeResize(count, 3);
  if (count < 3) {
    throw InputError(fmt::format("marker anchors: {} of them are in the take's neutral frame, at least 3 are needed",
                                 count));
  }
  return pairs;
}

bool spans_space(const Points& points) {
  if (points.rows() < 4) return false;
  const Points centred = points.rowwise() - points.colwise().mean();
  const Eigen::Matrix3d scatter = centred.transpose() * centred;
  // Ratio of volumes: points whose thickness is below about 1/1000 of their extent count as a plane.
  return scatter.determinant() > 1e-6 * std::pow(scatter.trace(), 3.0);
}

/// Similarity by the anchors, then the RBF through them.
Points warp(const Points& neutral, const AnchorPairs& pairs, const Similarity& rig_from_mocap) {
  Points moved = transformed(rig_from_mocap, neutral);
  const Points anchors = transformed(rig_from_mocap, pairs.mocap);
  if (!spans_space(anchors)) return moved;
  const RbfMap map(anchors, pairs.rig, {RbfKernel::inverse_multiquadric, true, 0.0});
  for (Eigen::Index i = 0; i < moved.rows(); ++i) {
    if (moved.row(i).allFinite()) moved.row(i) = map(Eigen::Vector3d(moved.row(i))).transpose();
  }
  return moved;
}

/// Markers whose distances to their nearest neighbours stretched unlike the others'.
void find_stretched(MarkerPlacement& placement, double limit) {
  const auto count = static_cast<int>(placement.labels.size());
  if (count < 6) return;
  const PointTree tree(placement.neutral);
  std::vector<double> stretch(count);
  for (int i = 0; i < count; ++i) {
    double before = 0.0, after = 0.0;
    for (const auto& neighbour : tree.nearest(placement.neutral.row(i).transpose(), 5)) {
      before += neighbour.distance;
      after += (placement.on_rig.row(i) - placement.on_rig.row(neighbour.index)).norm();
    }
    stretch[i] = after / before;
  }
  std::vector<double> sorted = stretch;
  std::nth_element(sorted.begin(), sorted.begin() + count / 2, sorted.end());
  const double typical = sorted[count / 2];
  for (int i = 0; i < count; ++i) {
    const double ratio = stretch[i] / typical;
    if (ratio > limit || ratio * limit < 1.0) {
      placement.suspects.push_back(fmt::format("{}: spacing to its neighbours is {:.2f} times that of the other markers",
                                               placement.labels[i], ratio));
    }
  }
}

void find_coincident(MarkerPlacement& placement) {
  constexpr double kSameSpot = 0.5;  // mm; real markers are at least 2 mm wide
  for (Eigen::Index i = 0; i < placement.on_rig.rows(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      if ((placement.on_rig.row(i) - placement.on_rig.row(j)).norm() < kSameSpot) {
        placement.suspects.push_back(placement.labels[i] + ": on the same spot as " + placement.labels[j]);
      }
    }
  }
}

void align_by_anchors(MarkerPlacement& placement, const AnchorPairs& pairs) {
  constexpr double kHandPlaced = 2.0;  // mm; nobody puts a marker closer than this to where a landmark is meant
  const RobustFit fit = fit_similarity_robust(pairs.mocap, pairs.rig, Scaling::free, kHandPlaced);
  placement.rig_from_mocap = fit.target_from_source;
  placement.anchor_rms = std::sqrt(fit.residuals.squaredNorm() / static_cast<double>(fit.residuals.size()));
  for (Eigen::Index i = 0; i < fit.weights.size(); ++i) {
    if (fit.weights[i] > 0.0) continue;
    placement.suspects.push_back(fmt::format("{}: as an anchor it is {:.1f} mm from where the others put it",
                                             pairs.labels[i], fit.residuals[i]));
  }
}

void add_marker(MarkerPlacement& placement, const std::string& label, const SurfacePoint& place,
                const Eigen::RowVector3d& neutral, const Eigen::Vector3d& on_rig, double distance) {
  const auto row = static_cast<Eigen::Index>(placement.labels.size());
  placement.labels.push_back(label);
  placement.places.push_back(place);
  placement.neutral.row(row) = neutral;
  placement.on_rig.row(row) = on_rig.transpose();
  placement.surface_distances.push_back(distance);
}

}  // namespace

void PlacementOptions::validate() const {
  if (!(max_distance > 0.0)) throw InputError("marker placement: max_distance must be positive");
  if (!(suspect_distance >= 0.0)) throw InputError("marker placement: suspect_distance must be 0 or more");
  if (!(suspect_stretch > 1.0)) throw InputError("marker placement: suspect_stretch must be above 1");
}

rig::MarkerPlaces MarkerPlacement::by_label() const {
  rig::MarkerPlaces result;
  for (std::size_t i = 0; i < labels.size(); ++i) result[labels[i]] = places[i];
  return result;
}

MarkerPlacement place_markers(const std::vector<std::string>& labels, const Points& neutral,
                              const rig::MarkerPlaces& anchors, const rig::Actor& actor,
                              const PlacementOptions& options) {
  options.validate();
  if (neutral.rows() != static_cast<Eigen::Index>(labels.size())) {
    throw InputError("marker placement: one neutral position a label is needed");
  }
  const AnchorPairs pairs = pair_anchors(labels, neutral, anchors, actor);
  MarkerPlacement placement;
  align_by_anchors(placement, pairs);
  const FaceSurface face(actor, options.face_set);
  const Points warped = warp(neutral, pairs, placement.rig_from_mocap);
  placement.neutral = placement.on_rig = Points::Zero(neutral.rows(), 3);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const Eigen::Vector3d position = warped.row(static_cast<Eigen::Index>(i));
    if (!position.allFinite()) {
      placement.left_out.push_back(labels[i] + ": missing in the neutral frame");
      continue;
    }
    const auto anchor = anchors.find(labels[i]);
    const SurfacePoint place = anchor != anchors.end() ? anchor->second : face.closest(position, options.max_distance);
    if (!place.valid()) {
      placement.left_out.push_back(
          fmt::format("{}: more than {:.0f} mm off the face, so no face marker", labels[i], options.max_distance));
      continue;
    }
    const Eigen::Vector3d on_rig = position_of(place, *actor.topology, actor.neutral());
    const double distance = (on_rig - position).norm();
    if (distance > options.suspect_distance) {
      placement.suspects.push_back(fmt::format("{}: {:.1f} mm from the face after warping", labels[i], distance));
    }
    add_marker(placement, labels[i], place, neutral.row(static_cast<Eigen::Index>(i)), on_rig, distance);
  }
  const auto placed = static_cast<Eigen::Index>(placement.labels.size());
  placement.neutral.conservativeResize(placed, 3);
  placement.on_rig.conservativeResize(placed, 3);
  find_stretched(placement, options.suspect_stretch);
  find_coincident(placement);
  return placement;
}

RbfMap rig_from_mocap(const MarkerPlacement& placement) {
  return RbfMap(placement.neutral, placement.on_rig, {RbfKernel::inverse_multiquadric, true, 0.0});
}

}  // namespace vultus::retarget
