#include "retarget/face.h"

#include <algorithm>


#include "core/error.h"
#include "core/files.h"

namespace vultus::retarget {
namespace {

Eigen::MatrixXf masks_of(const rig::Actor& actor, const std::vector<std::string>& regions) {
  Eigen::MatrixXf masks = Eigen::MatrixXf::Ones(actor.topology->vertex_count(),
                                                static_cast<Eigen::Index>(regions.size()));
  if (regions.size() == 1 && regions.front() == "whole") return masks;
  std::vector<std::string> known;
  for (const rig::Region& region : actor.regions) known.push_back(region.name);
  for (std::size_t k = 0; k < regions.size(); ++k) {
    const auto found = std::find(known.begin(), known.end(), regions[k]);
    if (found == known.end()) {
      throw InputError("the actor has no region \"" + regions[k] + "\"; the nearest is \"" +
                       nearest_name(regions[k], known) + "\"");
    }
    masks.col(static_cast<Eigen::Index>(k)) = actor.regions[found - known.begin()].vertex_mask;
  }
  return masks;
}

}  // namespace

Face::Face(const rig::Actor& actor, const std::vector<std::string>& poses, const std::vector<std::string>& regions)
    : actor_(actor), masks_(masks_of(actor, regions)) {
  for (const std::string& pose : poses) poses_.push_back(actor.pose_index(pose));
}

Eigen::MatrixXf Face::vertex_weights(const Weights& weights, int frame) const {
  if (weights.poses.size() != poses_.size() || static_cast<Eigen::Index>(weights.regions.size()) != masks_.cols()) {
    throw InputError("face: weights with other poses or regions than the face was made for");
  }
  Eigen::MatrixXf by_region(masks_.cols(), static_cast<Eigen::Index>(poses_.size()));
  for (Eigen::Index k = 0; k < masks_.cols(); ++k) {
    const auto row = weights.at(frame, static_cast<int>(k));
    by_region.row(k) = Eigen::Map<const Eigen::RowVectorXf>(row.data(), static_cast<Eigen::Index>(row.size()));
  }
  return masks_ * by_region;
}

Points Face::at(const Weights& weights, int frame) const {
  const Eigen::MatrixXf by_vertex = vertex_weights(weights, frame);
  // Relative to the neutral, so that masks which sum to one only to rounding move nothing.
  const Points& neutral = actor_.neutral();
  Points positions = neutral;
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    const Eigen::VectorXd along = by_vertex.col(static_cast<Eigen::Index>(i)).cast<double>();
    if (poses_[i] == 0 || along.maxCoeff() <= 0.0) continue;
    positions += ((actor_.poses[poses_[i]].positions - neutral).array().colwise() * along.array()).matrix();
  }
  return positions;
}

}  // namespace vultus::retarget
