#include "core/camera.h"

#include <Eigen/Geometry>
#include <cmath>

namespace vultus {

Eigen::Vector3d Camera::project(const Eigen::Vector3d& world) const {
  const Eigen::Vector3d p = camera_from_world_rotation * world + camera_from_world_translation;
  return {fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy, p.z()};
}

Eigen::Vector3d Camera::centre() const {
  return -(camera_from_world_rotation.transpose() * camera_from_world_translation);
}

Eigen::Vector3d Camera::direction(double x, double y) const {
  const Eigen::Vector3d in_camera((x - cx) / fx, (y - cy) / fy, 1.0);
  return (camera_from_world_rotation.transpose() * in_camera).normalized();
}

Camera Camera::look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const Eigen::Vector3d& up,
                       double vertical_fov, int width, int height) {
  const Eigen::Vector3d forward = (target - eye).normalized();
  Eigen::Vector3d right = forward.cross(up);
  if (right.norm() < 1e-9 * up.norm()) right = forward.unitOrthogonal();  // looking straight up or down
  right.normalize();

  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = 0.5 * height / std::tan(0.5 * vertical_fov);
  camera.cx = 0.5 * width;
  camera.cy = 0.5 * height;
  camera.camera_from_world_rotation.row(0) = right;
  camera.camera_from_world_rotation.row(1) = forward.cross(right);
  camera.camera_from_world_rotation.row(2) = forward;
  camera.camera_from_world_translation = -(camera.camera_from_world_rotation * eye);
  return camera;
}

}  // namespace vultus
