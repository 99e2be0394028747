#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "apps/virtual_stage/muscles.h"

namespace vultus::virtual_stage {

/// Skin on which side of the mouth's opening a pull takes along.
enum class Layer { all, above_mouth, below_mouth };

/// A muscle's hold on the skin: everything within an ellipsoid around a landmark is displaced, (1 - q²)² of the full
/// way at q of its reach. Given for the left side, in mm of a face whose outer eye corners are 90 mm apart.
struct Pull {
  std::string landmark;
  Eigen::Vector3d offset;  ///< of the ellipsoid's centre from the landmark; +x outward
  Eigen::Vector3d reach;
  Eigen::Vector3d displacement;  ///< at the centre
  double bulge = 0.0;            ///< further, along the skin's normal
  Layer layer = Layer::all;
};

/// What one side of a muscle pulls at strength 1.
const std::vector<Pull>& pulls(Muscle muscle);

/// What a muscle does to the lips as a ring; zeros for those that do nothing of the kind.
struct LipAction {
  double reach = 22.0;                        ///< mm around the line between the lips
  double narrow = 0.0;                        ///< share of the distance to the middle taken away
  double forward = 0.0;                       ///< mm
  double open_upper = 0.0, open_lower = 0.0;  ///< mm, at the middle
  double thin_upper = 0.0, thin_lower = 0.0;  ///< share of the distance to the line taken away
  double in_upper = 0.0, in_lower = 0.0;      ///< mm backwards between the teeth
  bool any() const;
};
LipAction lip_action(Muscle muscle);

}  // namespace vultus::virtual_stage
