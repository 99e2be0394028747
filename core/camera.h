#pragma once

#include <Eigen/Core>

namespace vultus {

/// Pinhole camera, OpenCV axes (x right, y down, z forward), pixel centres at +0.5.
struct Camera {
  int width = 0, height = 0;                                            // pixels
  double fx = 0, fy = 0, cx = 0, cy = 0;                                // pixels
  Eigen::Matrix3d camera_from_world_rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d camera_from_world_translation = Eigen::Vector3d::Zero();  // mm

  /// World point → (x, y) in pixels and z depth along the optical axis in mm.
  Eigen::Vector3d project(const Eigen::Vector3d& world) const;
  Eigen::Vector3d centre() const;                                ///< world, mm
  Eigen::Vector3d direction(double x, double y) const;           ///< unit, world, through continuous pixel (x, y)

  /// Camera at `eye` looking at `target` with +y up; `vertical_fov` in radians.
  static Camera look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const Eigen::Vector3d& up,
                        double vertical_fov, int width, int height);
};

}  // namespace vultus
