#include "apps/virtual_stage/muscle_fields.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "apps/virtual_stage/jaw.h"
#include "apps/virtual_stage/pulls.h"

namespace vultus::virtual_stage {
namespace {

// +1 above the mouth, -1 below, smooth between beyond its corners.
Eigen::VectorXd above_mouth(const FaceFeatures& face) {
  const std::vector<bool> upper = face.members("upper_lip"), lower = face.members("lower_lip"),
                          lips = face.members("lips");
  const double nose = face.at("9.15").y(), fold = face.at("labiomental").y();
  std::vector<std::pair<int, double>> given;
  for (int v = 0; v < face.topology.vertex_count(); ++v) {
    const double opening = std::sqrt(mouth_opening(along_mouth(face, face.positions(v, 0))));
    if (upper[v])
      given.emplace_back(v, opening);
    else if (lower[v])
      given.emplace_back(v, -opening);
    else if (lips[v])
      given.emplace_back(v, 0.0);
    else if (face.positions(v, 1) > nose)
      given.emplace_back(v, 1.0);
    else if (face.positions(v, 1) < fold)
      given.emplace_back(v, -1.0);
  }
  return face.fields.through(given).cwiseMax(-1.0).cwiseMin(1.0);
}

class FieldMaker {
 public:
  FieldMaker(const FaceFeatures& face, const Eigen::VectorXd& hold) : face_(face), above_(above_mouth(face)) {
    soft_ = (1.0 - hold.array()).matrix();
    // Along the lips normals turn from outward to into the mouth within millimetres: nothing swells along them.
    swelling_ = Eigen::VectorXd::Ones(soft_.size());
    for (const char* set : {"lips", "inner_mouth"})
      for (const int v : face.topology.set(set)) swelling_[v] = 0.0;
    soften(swelling_, face.topology, 20);
    swelling_ = swelling_.unaryExpr([](double s) { return smooth_step(0.55, 1.0, s); });
    for (const char* set : {"eyeballs", "teeth"})
      for (const int v : face.topology.set(set)) soft_[v] = 0.0;
  }

  MuscleField field(Muscle muscle, Side side) const {
    Points moved = Points::Zero(face_.topology.vertex_count(), 3);
    for (const Pull& pull : pulls(muscle)) add(pull, side, moved);
    add_lip_action(muscle, side, moved);
    return compacted(moved);
  }

 private:
  // Which side of the face a vertex counts to: a side's action fades out across the middle.
  double share(Side side, double x) const {
    const double width = 7.0 * face_.scale;
    return side == Side::left ? smooth_step(-width, width, x) : 1.0 - smooth_step(-width, width, x);
  }

  double mask(Layer layer, int v) const {
    switch (layer) {
      case Layer::above_mouth:
        return smooth_step(-0.15, 0.75, above_[v]);
      case Layer::below_mouth:
        return smooth_step(-0.15, 0.75, -above_[v]);
      case Layer::all:
        break;
    }
    return 1.0;
  }

  void add(const Pull& pull, Side side, Points& moved) const {
    const double s = face_.scale, lateral = side == Side::left ? 1.0 : -1.0;
    const Eigen::Vector3d flip(lateral, 1, 1);
    const Eigen::Vector3d centre = face_.at(pull.landmark, side) + s * pull.offset.cwiseProduct(flip);
    for (Eigen::Index v = 0; v < moved.rows(); ++v) {
      const Eigen::Vector3d p = face_.positions.row(v);
      const double q = ((p - centre) / s).cwiseQuotient(pull.reach).squaredNorm();
      if (q >= 1.0 || soft_[v] <= 0.0) continue;
      const double w = std::pow(1.0 - q, 2) * soft_[v] * share(side, p.x()) * mask(pull.layer, static_cast<int>(v));
      const Eigen::Vector3d normal = face_.normals.row(v);
      moved.row(v) += (w * s * (pull.displacement.cwiseProduct(flip) + pull.bulge * swelling_[v] * normal)).transpose();
    }
  }

  // Actions of the ring muscle, which close, push out or roll the lips along the whole mouth.
  void add_lip_action(Muscle muscle, Side side, Points& moved) const {
    const LipAction action = lip_action(muscle);
    if (!action.any()) return;
    const double s = face_.scale;
    const Eigen::Vector3d left = face_.at("2.4"), right = face_.at("2.4", Side::right), middle = face_.at("2.2");
    const double centre_x = 0.5 * (left.x() + right.x());
    for (Eigen::Index v = 0; v < moved.rows(); ++v) {
      const Eigen::Vector3d p = face_.positions.row(v);
      const double along = along_mouth(face_, p.x()), inside = std::max(0.0, 1.0 - along * along);
      const double t = std::min(std::abs(along), 1.0);
      const double line_y = middle.y() + (0.5 * (left.y() + right.y()) - middle.y()) * t * t;
      const double line_z = middle.z() + (0.5 * (left.z() + right.z()) - middle.z()) * t * t;
      const double dx = std::max(0.0, std::abs(along) - 0.75) * 0.5 * (left.x() - right.x());
      const double dy = p.y() - line_y, dz = std::min(0.0, p.z() - line_z + 6 * s);
      const double q = (dx * dx + dy * dy + 0.25 * dz * dz) / std::pow(action.reach * s, 2);
      if (q >= 1.0 || soft_[v] <= 0.0) continue;
      const double w = std::pow(1.0 - q, 2) * soft_[v] * share(side, p.x());
      const double up = mask(Layer::above_mouth, static_cast<int>(v)) - mask(Layer::below_mouth, static_cast<int>(v));
      const double near_line = std::exp(-dy * dy / (2 * std::pow(6.0 * s, 2)));
      const double upper = std::max(0.0, up), lower = std::max(0.0, -up);
      Eigen::Vector3d d;
      d.x() = -action.narrow * (p.x() - centre_x);
      d.y() = s * inside * (action.open_upper * upper - action.open_lower * lower) -
              (action.thin_upper * upper + action.thin_lower * lower) * dy * near_line;
      d.z() = s * (action.forward * (1.0 - 0.45 * t * t) -
                   near_line * inside * (action.in_upper * upper + action.in_lower * lower));
      moved.row(v) += (w * d).transpose();
    }
  }

  static MuscleField compacted(const Points& moved) {
    MuscleField field;
    constexpr double still = 1e-4;  // mm
    for (Eigen::Index v = 0; v < moved.rows(); ++v)
      if (moved.row(v).norm() > still) field.vertices.push_back(static_cast<int>(v));
    field.displacement.resize(field.vertices.size(), 3);
    for (std::size_t i = 0; i < field.vertices.size(); ++i) field.displacement.row(i) = moved.row(field.vertices[i]);
    return field;
  }

  const FaceFeatures& face_;
  Eigen::VectorXd above_, soft_, swelling_;
};

}  // namespace

std::vector<MuscleField> muscle_fields(const FaceFeatures& face, const Eigen::VectorXd& hold) {
  const FieldMaker maker(face, hold);
  std::vector<MuscleField> fields;
  for (int m = 0; m < muscle_count; ++m)
    for (const Side side : {Side::left, Side::right}) fields.push_back(maker.field(static_cast<Muscle>(m), side));
  return fields;
}

}  // namespace vultus::virtual_stage
