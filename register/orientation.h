#pragma once

#include "core/transform.h"
#include "register/template.h"

namespace vultus::registration {

/// The points of one pose that Zhu §4.7 turns a face by: the middles of both eyes and two points of the nose ridge.
struct OrientationPoints {
  Eigen::Vector3d right_eye, left_eye;        ///< middles between the corners (the subject's right is at −x)
  Eigen::Vector3d ridge_top, ridge_tip;       ///< nose ridge
  Eigen::Vector3d right_corner, left_corner;  ///< outer corners of the eyes
};

/// From the template's 68-point scheme on any pose of its topology; nothing where the template has no such points.
std::optional<OrientationPoints> orientation_points(const Template& head, const Points& positions);

/// Rigid motion into the face frame (Zhu §4.7): the line between the eyes along +x (steps 2 and 3), the nose ridge at
/// the same angle to the vertical in the side view as `model`'s (step 1), outer eye corners' middle where `model`'s is.
/// `model` is the same person's neutral, or the template for a neutral.
Similarity normalize_orientation(const OrientationPoints& pose, const OrientationPoints& model);

}  // namespace vultus::registration
