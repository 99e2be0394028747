#pragma once

#include "apps/virtual_stage/face_features.h"

namespace vultus::virtual_stage {

/// The jaw: turns about the axis through both condyles while they slide forward and down; skin follows by `weight`.
struct JawMotion {
  Eigen::Vector3d hinge = Eigen::Vector3d::Zero();  ///< middle of the axis, mm
  double scale = 1.0;
  Eigen::VectorXd weight;  ///< vertex_count, 0 (skull) … 1 (chin, lower teeth)

  /// `open`, `left`, `forward` as `Jaw` channels: 1 is 21°, 8 mm, 6 mm.
  void apply(Points& positions, double open, double left, double forward) const;
};

JawMotion jaw_motion(const FaceFeatures& face);

/// Where a vertex is along the mouth, -1 right corner … 1 left corner, and beyond.
double along_mouth(const FaceFeatures& face, double x);
/// Height of the mouth's opening at `along` relative to its middle: an ellipse.
double mouth_opening(double along);

}  // namespace vultus::virtual_stage
