#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "core/camera.h"
#include "core/random.h"

namespace vultus {
namespace {

TEST(Camera, LooksAlongItsAxisWithXRightAndYDown) {
  // From +z towards the origin: world +x appears right of the centre, world +y above it (smaller row).
  const Camera camera = Camera::look_at({0, 0, 100}, {0, 0, 0}, {0, 1, 0}, std::numbers::pi / 2, 200, 100);
  EXPECT_NEAR((camera.project({0, 0, 0}) - Eigen::Vector3d(100, 50, 100)).norm(), 0, 1e-12);
  // At 90 degrees the half height of 50 pixels spans 100 mm at 100 mm depth.
  EXPECT_NEAR((camera.project({100, 0, 0}) - Eigen::Vector3d(150, 50, 100)).norm(), 0, 1e-9);
  EXPECT_NEAR((camera.project({0, 100, 0}) - Eigen::Vector3d(100, 0, 100)).norm(), 0, 1e-9);
  EXPECT_NEAR((camera.centre() - Eigen::Vector3d(0, 0, 100)).norm(), 0, 1e-12);
}

TEST(Camera, RotationIsProper) {
  for (const Eigen::Vector3d& eye : {Eigen::Vector3d(3, 4, 5), Eigen::Vector3d(0, 9, 0), Eigen::Vector3d(0, -9, 0)}) {
    const Eigen::Matrix3d r = Camera::look_at(eye, {0, 0, 0}, {0, 1, 0}, 0.5, 64, 64).camera_from_world_rotation;
    EXPECT_NEAR(r.determinant(), 1.0, 1e-12);
    EXPECT_NEAR((r * r.transpose() - Eigen::Matrix3d::Identity()).norm(), 0, 1e-12);
  }
}

TEST(Camera, DirectionUndoesProject) {
  const Camera camera = Camera::look_at({30, -20, 400}, {1, 2, 3}, {0, 1, 0}, 0.6, 320, 240);
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d world(random.uniform(-90, 90), random.uniform(-90, 90), random.uniform(-90, 90));
    const Eigen::Vector3d pixel = camera.project(world);
    const Eigen::Vector3d direction = camera.direction(pixel.x(), pixel.y());
    EXPECT_NEAR((direction - (world - camera.centre()).normalized()).norm(), 0, 1e-12);
  }
}

}  // namespace
}  // namespace vultus
