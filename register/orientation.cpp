#include "register/orientation.h"

#include <Eigen/Geometry>
#include <cmath>

namespace vultus::registration {
namespace {

// Angle of the ridge against the vertical, seen from the side.
double ridge_angle(const Eigen::Vector3d& ridge) { return std::atan2(ridge.z(), -ridge.y()); }

}  // namespace

std::optional<OrientationPoints> orientation_points(const Template& head, const Points& positions) {
  if (!head.ibug68) return {};
  for (int needed : {27, 30, 36, 39, 42, 45})
    if ((*head.ibug68)[needed] < 0) return {};
  auto point = [&](int i) -> Eigen::Vector3d { return positions.row((*head.ibug68)[i]).transpose(); };
  return OrientationPoints{
      0.5 * (point(36) + point(39)), 0.5 * (point(42) + point(45)), point(27), point(30), point(36), point(45)};
}

Similarity normalize_orientation(const OrientationPoints& pose, const OrientationPoints& model) {
  const Eigen::Vector3d eyes = (pose.left_eye - pose.right_eye).normalized();
  // Steps 2 and 3: about y until the line between the eyes lies in the x-y plane, about z until it lies along x.
  const double yaw = std::atan2(eyes.z(), eyes.x());
  const Eigen::Matrix3d about_y = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const Eigen::Vector3d flat = about_y * eyes;
  const Eigen::Matrix3d about_z =
      Eigen::AngleAxisd(-std::atan2(flat.y(), flat.x()), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Matrix3d level = about_z * about_y;
  // Step 1 last, so that the turn about x leaves the eyes' line where it is.
  const double pitch =
      ridge_angle(level * (pose.ridge_tip - pose.ridge_top)) - ridge_angle(model.ridge_tip - model.ridge_top);
  Similarity face;
  face.rotation = Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX()).toRotationMatrix() * level;
  const Eigen::Vector3d middle = 0.5 * (pose.right_corner + pose.left_corner);
  face.translation = 0.5 * (model.right_corner + model.left_corner) - face.rotation * middle;
  return face;
}

}  // namespace vultus::registration
