#include "apps/virtual_stage/detail.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "apps/virtual_stage/solid_noise.h"
#include "core/error.h"

namespace vultus::virtual_stage {
namespace {

// Skin that folds and has pores: not eyes, teeth, the mouth's inside or the lids' edges.
Eigen::VectorXd skin_share(const Topology& topology) {
  Eigen::VectorXd share = Eigen::VectorXd::Zero(topology.vertex_count());
  for (const int v : topology.set("skin")) share[v] = 1.0;
  for (const char* set : {"lid_line_upper_left", "lid_line_lower_left", "lid_line_upper_right", "lid_line_lower_right",
                          "inner_mouth", "eyeballs", "neck_boundary"})
    for (const int v : topology.set(set)) share[v] = 0.0;
  return share;
}

// Pits about 1.2 mm apart over an uneven ground; on the lips, upright lines instead.
Eigen::VectorXd relief(const Points& fine, const Eigen::VectorXd& skin, const Eigen::VectorXd& lips, double scale,
                       const DetailOptions& options) {
  Eigen::VectorXd height = Eigen::VectorXd::Zero(fine.rows());
  for (Eigen::Index v = 0; v < fine.rows(); ++v) {
    if (skin[v] <= 0.0) continue;
    const Eigen::Vector3d p = fine.row(v).transpose() / scale;
    const double ground =
        0.045 * solid_noise(p / 3.1, options.seed + 1) + 0.03 * solid_noise(p / 1.4, options.seed + 2);
    const double pit = std::max(0.0, solid_noise(p / 1.05, options.seed + 3) - 0.25);
    const double lines = solid_noise(Eigen::Vector3d(p.x() / 0.9, p.y() / 7.0, p.z() / 6.0), options.seed + 4);
    height[v] = options.pores * skin[v] * ((1.0 - lips[v]) * (ground - 0.10 * pit) + lips[v] * 0.10 * lines);
  }
  return height;
}

}  // namespace

void DetailOptions::validate() const {
  if (levels < 0 || levels > 3) throw UsageError("detail option levels must be 0 … 3");
  if (!(folds >= 0 && folds <= 2)) throw UsageError("detail option folds must be 0 … 2");
  if (!(pores >= 0 && pores <= 3)) throw UsageError("detail option pores must be 0 … 3");
}

DetailedFace::DetailedFace(const FaceModel& face, const DetailOptions& options)
    : face_(face), subdivision_((options.validate(), face.topology()), options.levels), fold_scale_(options.folds) {
  const Topology& fine = *topology();
  const Points rest = subdivision_(face.neutral());
  const FaceFeatures features(*face.topology(), face.neutral());
  Eigen::VectorXd skin = skin_share(fine), lips = Eigen::VectorXd::Zero(fine.vertex_count());
  for (const int v : fine.set("lips")) lips[v] = 1.0;
  soften(skin, fine, 4);
  soften(lips, fine, 6);
  folds_ = folds(features, rest, skin.cwiseProduct((1.0 - lips.array()).matrix()));
  relief_ = relief(rest, skin, lips, features.scale, options);

  chin_ = chin_bumps_ = Eigen::VectorXd::Zero(rest.rows());
  const Eigen::Vector3d middle = features.at("2.10");
  for (Eigen::Index v = 0; v < rest.rows(); ++v) {
    const Eigen::Vector3d p = rest.row(v);
    const double near = 1.0 - (p - middle).cwiseQuotient(features.scale * Eigen::Vector3d(20, 13, 20)).squaredNorm();
    if (near <= 0 || skin[v] <= 0) continue;
    chin_[v] = skin[v] * near;
    chin_bumps_[v] = 0.45 * features.scale * solid_noise(p / (2.4 * features.scale), options.seed + 5);
  }
}

Points DetailedFace::pose(const Activations& activations) const {
  Points positions = subdivision_(face_.pose(activations));
  Eigen::VectorXd height = relief_;
  for (const Fold& fold : folds_) {
    const double strength = fold_scale_ * fold.strength(activations);
    if (strength == 0.0) continue;
    for (std::size_t i = 0; i < fold.vertices.size(); ++i) height[fold.vertices[i]] += strength * fold.depth[i];
  }
  const double mentalis = 0.5 * (activations[channel(Muscle::chin_raiser, Side::left)] +
                                 activations[channel(Muscle::chin_raiser, Side::right)]);
  height += fold_scale_ * std::max(0.0, mentalis) * chin_.cwiseProduct(chin_bumps_);
  const Points normals = vertex_normals(*topology(), positions);
  positions += height.asDiagonal() * normals;
  return positions;
}

}  // namespace vultus::virtual_stage
