#include "register/face_axes.h"

#include <Eigen/Geometry>

namespace vultus::registration {

FaceAxes face_axes(const Eigen::Vector3d& leftward, const Eigen::Vector3d& upward) {
  FaceAxes axes;
  axes.across = leftward.normalized();
  axes.up = (upward - axes.across * axes.across.dot(upward)).normalized();
  axes.front = axes.across.cross(axes.up);
  return axes;
}

}  // namespace vultus::registration
