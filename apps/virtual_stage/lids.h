#pragma once

#include <vector>

#include "apps/virtual_stage/face_features.h"

namespace vultus::virtual_stage {

/// One eye's lids: angles about the axis through the eyeball's centre along the eye corners.
struct LidMotion {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero(), axis = Eigen::Vector3d::UnitX();
  double radius = 0.0;        ///< of the eyeball, mm
  std::vector<int> vertices;  ///< that move with the lids
  Eigen::VectorXd upper;      ///< for each of `vertices`, how far the upper lid lowers it when closed, radians
  Eigen::VectorXd lower;      ///< the same for the lower lid, which rises
  Eigen::VectorXd clearance;  ///< for each, least distance from the eyeball's centre, mm

  /// Turns the lids in `positions`; 0 is rest and 1 closed, for each lid. The lids meet and never cross, since both
  /// stop at one line.
  void apply(Points& positions, double upper_closed, double lower_closed) const;
};

LidMotion lid_motion(const FaceFeatures& face, Side side);

/// How firmly each vertex (vertex_count) is held by a lid margin, 1 there and 0 beyond the lids: what other muscles
/// must leave alone.
Eigen::VectorXd lid_hold(const FaceFeatures& face);

}  // namespace vultus::virtual_stage
