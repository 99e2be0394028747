#include "apps/virtual_stage/random_pose.h"

#include <Eigen/Geometry>

namespace vultus::virtual_stage {

Similarity random_pose(Random random, double max_rotation, double max_shift) {
  double v[6];
  for (double& value : v) value = random.uniform(-1.0, 1.0);
  Similarity pose;
  pose.rotation = (Eigen::AngleAxisd(max_rotation * v[0], Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(max_rotation * v[1], Eigen::Vector3d::UnitX()) *
                   Eigen::AngleAxisd(max_rotation * v[2], Eigen::Vector3d::UnitZ()))
                      .toRotationMatrix();
  pose.translation = max_shift * Eigen::Vector3d(v[3], v[4], v[5]);
  return pose;
}

}  // namespace vultus::virtual_stage
