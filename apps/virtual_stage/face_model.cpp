#include "apps/virtual_stage/face_model.h"

#include <algorithm>
#include <cmath>

#include "apps/virtual_stage/face_features.h"
#include "core/error.h"
#include "register/subdivide.h"

namespace vultus::virtual_stage {
namespace {

std::vector<std::pair<int, int>> contact_pairs(const FaceFeatures& face) {
  const std::vector<int> upper = face.line("lip_line_upper"), lower = face.line("lip_line_lower");
  if (upper.size() != lower.size()) throw InputError("face model: the lips' contact lines differ in length");
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t i = 0; i < upper.size(); ++i) pairs.emplace_back(upper[i], lower[i]);
  return pairs;
}

double place_among(const FaceFeatures& face, const std::vector<std::pair<int, int>>& pairs, double x) {
  std::vector<std::pair<double, double>> places;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    places.emplace_back(face.positions(pairs[i].first, 0), static_cast<double>(i));
  return interpolate(places, x);
}

}  // namespace

FaceModel::FaceModel(const registration::Template& head, const Points& control) {
  const registration::LoopSubdivision subdivision(with_contact_lines(head), head.subdivisions);
  topology_ = subdivision.refined();
  neutral_ = subdivision(control);
  const FaceFeatures face(*topology_, neutral_);
  fields_ = muscle_fields(face, lid_hold(face));
  lids_ = {lid_motion(face, Side::left), lid_motion(face, Side::right)};
  jaw_ = jaw_motion(face);
  lip_pairs_ = contact_pairs(face);

  const std::vector<bool> upper = face.members("upper_lip"), lower = face.members("lower_lip");
  const double reach = 13.0 * face.scale;
  for (int v = 0; v < topology_->vertex_count(); ++v) {
    const Eigen::Vector3d p = neutral_.row(v);
    const double place = place_among(face, lip_pairs_, p.x());
    const auto [u, l] = lip_pairs_[static_cast<std::size_t>(std::lround(place))];
    const double dy = p.y() - 0.5 * (neutral_(u, 1) + neutral_(l, 1)), dz = std::max(0.0, neutral_(u, 2) - p.z() - 8.0);
    const double q = (dy * dy + 0.5 * dz * dz) / (reach * reach);
    const bool above = upper[v] || (!lower[v] && dy > 0);
    if (q < 1.0 && std::abs(along_mouth(face, p.x())) < 1.0)
      lip_followers_.push_back({v, std::pow(1.0 - q, 2), place, above});
  }
}

Points FaceModel::pose(const Activations& activations) const {
  if (activations.size() != channel_count)
    throw InputError("face model: " + std::to_string(activations.size()) + " activations, not " +
                     std::to_string(channel_count));
  Points positions = neutral_;
  for (int c = 0; c < 2 * muscle_count; ++c) {
    if (activations[c] == 0.0) continue;
    const MuscleField& field = fields_[c];
    for (std::size_t i = 0; i < field.vertices.size(); ++i)
      positions.row(field.vertices[i]) += activations[c] * field.displacement.row(i);
  }
  keep_lips_apart(positions);
  jaw_.apply(positions, activations[channel(Jaw::open)], activations[channel(Jaw::left)],
             activations[channel(Jaw::forward)]);
  close_lids(positions, activations);
  return positions;
}

void FaceModel::close_lids(Points& positions, const Activations& activations) const {
  for (const Side side : {Side::left, Side::right}) {
    const auto strength = [&](Muscle muscle) { return activations[channel(muscle, side)]; };
    const double closing = strength(Muscle::lid_closer), squint = strength(Muscle::lid_tightener),
                 cheek = strength(Muscle::cheek_raiser), raise = strength(Muscle::lid_raiser);
    const double brow = strength(Muscle::brow_lowerer);
    // The lower lid moves little in a blink; what narrows an eye in a smile or squint is mostly the lower lid. Its
    // share of the closed line's height is small, so its angle is large.
    const double upper = closing + (1.0 - closing) * (0.28 * squint + 0.10 * cheek + 0.08 * brow - 0.32 * raise);
    const double lower = std::min(1.0, closing + (1.0 - closing) * (1.4 * squint + 1.0 * cheek - 0.25 * raise));
    lids_[static_cast<int>(side)].apply(positions, upper, lower);
  }
}

void FaceModel::keep_lips_apart(Points& positions) const {
  const std::size_t n = lip_pairs_.size();
  std::vector<double> overlap(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto [u, l] = lip_pairs_[i];
    const double gap = positions(u, 1) - positions(l, 1), neutral_gap = neutral_(u, 1) - neutral_(l, 1);
    overlap[i] = std::max(0.0, neutral_gap - gap);
  }
  if (std::all_of(overlap.begin(), overlap.end(), [](double o) { return o < 1e-9; })) return;
  for (const LipFollower& follower : lip_followers_) {
    const std::size_t i = std::min(static_cast<std::size_t>(follower.place), n - 2);
    const double t = follower.place - static_cast<double>(i);
    const double push = 0.5 * follower.share * ((1.0 - t) * overlap[i] + t * overlap[i + 1]);
    positions(follower.vertex, 1) += follower.upper ? push : -push;
  }
}

}  // namespace vultus::virtual_stage
