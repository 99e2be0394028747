#pragma once

#include <Eigen/Core>

namespace vultus::registration {

/// Right-handed unit axes of a face or of a part of one.
struct FaceAxes {
  Eigen::Vector3d across;  ///< to the subject's left
  Eigen::Vector3d up;
  Eigen::Vector3d front;  ///< out of the face
};

/// `across` along `leftward`, `up` as near to `upward` as is square to it. Neither may be zero, nor both parallel.
FaceAxes face_axes(const Eigen::Vector3d& leftward, const Eigen::Vector3d& upward);

}  // namespace vultus::registration
