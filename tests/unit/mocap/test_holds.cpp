#include "mocap/holds.h"
#include "mocap/key_poses.h"
#include "tests/unit/mocap/takes.h"

namespace vultus::mocap {
namespace {

/// Neutral and poses in turn, a second each with half a second between: `sizes` mm, of all 60 markers where that is
/// large, of six where it is below 3 mm. 0.03 mm of noise, what cleaning leaves
/// of 0.1.
Take poses_of(const std::vector<double>& sizes) {
  const Points face = face_markers(60);
  const int period = 360, frames = period * static_cast<int>(sizes.size()) + 120;
  Take take = Take::empty("training", 120.0, numbered("m", 60), frames);
  Random random(9);
  for (int f = 0; f < frames; ++f) {
    const int turn = std::min(f / period, static_cast<int>(sizes.size()) - 1), at = f - turn * period;
    const double rise = std::clamp((at - 120) / 60.0, 0.0, 1.0), fall = std::clamp((at - 300) / 60.0, 0.0, 1.0);
    const double shown = 0.5 * (std::cos(EIGEN_PI * fall) - std::cos(EIGEN_PI * rise));  // smooth at both ends
    const double size = sizes[static_cast<std::size_t>(turn)];
    for (int m = 0; m < 60; ++m) {
      const bool moves = size >= 3.0 || m < 6;
      take.set(f, m,
               face.row(m).transpose() + Eigen::Vector3d(0, moves ? size * shown : 0.0, 0) + jitter(random, 0.03));
    }
  }
  return take;
}

TEST(Holds, PosesOfFewMarkersAreFoundAmongLargeOnes) {
  const std::vector<double> sizes = {12.0, 1.8, 20.0, 2.4, 8.0};
  const KeyPoses keys = find_key_poses(poses_of(sizes), {"neutral", "a", "b", "c", "d", "e"});
  for (int k = 0; k < 5; ++k) {
    const auto [first, last] = keys.holds[static_cast<std::size_t>(k) + 1];
    EXPECT_NEAR(first, 360 * k + 180, 25) << k;  // the slow ends of a motion of 60 frames count as rest
    EXPECT_NEAR(last, 360 * k + 300, 25) << k;
    EXPECT_NEAR(keys.positions[static_cast<std::size_t>(k) + 1](2, 1) - keys.positions[0](2, 1),
                sizes[static_cast<std::size_t>(k)], 0.1);
    EXPECT_GT(keys.scores[static_cast<std::size_t>(k) + 1], 0.8);
  }
  for (int m = 0; m < 60; ++m) EXPECT_NEAR(keys.positions[0](m, 1), face_markers(60)(m, 1), 0.05);
}

TEST(Holds, ARestStaysWhole) {
  const auto holds = find_holds(poses_of({12.0}));
  ASSERT_EQ(holds.size(), 3U);  // neutral, pose, neutral
}

}  // namespace
}  // namespace vultus::mocap
