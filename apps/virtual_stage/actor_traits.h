#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace vultus::virtual_stage {

/// A smooth way in which heads differ: the displacement (mm) that one standard deviation makes at a point of the
/// template's neutral.
struct Trait {
  std::string name;
  Eigen::Vector3d (*displacement)(const Eigen::Vector3d& p);
};

/// Mirror symmetric traits of the skull and the soft face, without those of the eyes.
const std::vector<Trait>& face_traits();
/// Differences between left and right, in the order of `Identity::asymmetry`.
const std::vector<Trait>& asymmetric_traits();

}  // namespace vultus::virtual_stage
