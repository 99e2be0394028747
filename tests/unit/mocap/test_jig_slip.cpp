#include "mocap/head_smoothing.h"
#include "mocap/jig_slip.h"
#include "mocap/stabilize.h"
#include "tests/unit/mocap/takes.h"

namespace vultus::mocap {
namespace {

Points five_targets() {
  Points jig(5, 3);
  jig << 0, 90, 60, 70, 50, 40, -70, 50, 40, 80, 60, -20, -78, 66, -24;
  return jig;
}

Similarity head_at(double t) {
  Similarity pose;
  pose.rotation = (Eigen::AngleAxisd(0.25 * std::sin(1.7 * t), Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(0.15 * std::sin(2.3 * t + 1), Eigen::Vector3d::UnitX()))
                      .toRotationMatrix();
  pose.translation = Eigen::Vector3d(20 * std::sin(t), 1200 + 8 * std::cos(1.3 * t), 200);
  return pose;
}

/// A jig on a moving head, 20 s at 60 Hz, and twelve points fixed to the head below it.
Take jig_take(double noise) {
  const Points jig = five_targets(), face = face_markers(12);
  std::vector<std::string> labels = numbered("jig", 5);
  for (const std::string& label : numbered("f", 12)) labels.push_back(label);
  Take take = Take::empty("jig", 60.0, labels, 1200);
  Random random(4);
  for (int f = 0; f < take.frames(); ++f) {
    for (int m = 0; m < 17; ++m) {
      const Eigen::Vector3d p = m < 5 ? jig.row(m) : face.row(m - 5);
      take.set(f, m, head_at(f / 60.0) * p + jitter(random, noise));
    }
  }
  return take;
}

void slip(Take& take, int marker, int from, const Eigen::Vector3d& way) {
  for (int f = from; f < take.frames(); ++f) take.set(f, marker, take.at(f, marker) + head_at(f / 60.0).rotation * way);
}

/// RMS of what points fixed to the head still move.
double motion_left(const std::vector<HeadPose>& poses) {
  const Points fixed = face_markers(12);
  Points mean = Points::Zero(12, 3);
  std::vector<Points> left;
  for (std::size_t f = 0; f < poses.size(); ++f) {
    left.push_back(transformed(poses[f].world_from_head.inverse() * head_at(static_cast<double>(f) / 60.0), fixed));
    mean += left.back() / static_cast<double>(poses.size());
  }
  double sum = 0.0;
  for (const Points& points : left) sum += (points - mean).squaredNorm() / 12.0;
  return std::sqrt(sum / static_cast<double>(poses.size()));
}

TEST(JigSlip, IsFoundAndPlacedInTime) {
  Take take = jig_take(0.1);
  slip(take, 1, 700, {1.2, -1.6, 0});  // 2 mm
  const Stabilized head = stabilize(take);
  ASSERT_EQ(head.slips.size(), 1U);
  EXPECT_EQ(head.slips[0].label, "jig2");
  EXPECT_NEAR(head.slips[0].frame, 700, 2);        // 2 mm are twenty times the noise
  EXPECT_NEAR(head.slips[0].distance, 2.0, 0.15);  // medians of hundreds of samples of 0.1 mm
  EXPECT_NE(head.decisions[0].find("jig2 slips"), std::string::npos);
}

TEST(JigSlip, LeavesTheHeadStill) {
  Take take = jig_take(0.1);
  slip(take, 1, 700, {1.2, -1.6, 0});
  StabilizeOptions ignored;
  ignored.find_slips = false;
  const double with = motion_left(stabilize(take).poses), without = motion_left(stabilize(take, ignored).poses);
  EXPECT_LT(with, 0.09);  // sixty frames a second give half the samples of the stage, where 0.05 is asked
  EXPECT_LT(with, 0.9 * without);
}

TEST(JigSlip, NoneInAFirmJig) {
  EXPECT_TRUE(stabilize(jig_take(0.1)).slips.empty());
  EXPECT_TRUE(stabilize(jig_take(0.4)).slips.empty());
}

TEST(JigSlip, BetweenTakesOfASession) {
  const Stabilized first = stabilize(jig_take(0.05));
  Take second = jig_take(0.05);
  slip(second, 3, 0, {0, 0, 3});
  StabilizeOptions options;
  options.body = first.body;
  const Stabilized head = stabilize(second, options);
  ASSERT_EQ(head.slips.size(), 1U);
  EXPECT_EQ(head.slips[0].label, "jig4");
  EXPECT_EQ(head.slips[0].frame, 0);
  EXPECT_EQ(head.body.labels, first.body.labels);
  EXPECT_LT(motion_left(head.poses), 0.06);
}

TEST(JigSlip, ThreeTargetsAreKeptAndItIsSaid) {
  Take all = jig_take(0.05);
  slip(all, 0, 600, {0, 3, 0});
  StabilizeOptions options;
  options.jig = {"jig1", "jig2", "jig3"};
  options.reuse_slipped = false;
  for (const HeadPose& pose : stabilize(all, options).poses) EXPECT_NE(pose.kind, HeadPose::Kind::none);
}

TEST(HeadSmoothing, StraightMotionStaysAsItIs) {
  const RigidBody body{numbered("j", 5), five_targets(), Eigen::VectorXd::Constant(5, 0.1)};
  std::vector<HeadPose> poses(200);
  for (std::size_t f = 0; f < poses.size(); ++f) {
    poses[f].kind = HeadPose::Kind::measured;
    poses[f].world_from_head.translation = Eigen::Vector3d(0.3 * static_cast<double>(f), 5, 0);
    poses[f].deviation = 0.1;
    poses[f].markers = 5;
  }
  const std::vector<HeadPose> smooth = smoothed_poses(poses, body, 60.0);
  for (std::size_t f = 0; f < poses.size(); ++f) {
    EXPECT_LT((smooth[f].world_from_head.translation - poses[f].world_from_head.translation).norm(), 1e-6);
  }
}

TEST(HeadSmoothing, TakesNoiseOutAndLeavesAKnock) {
  StabilizeOptions raw;
  raw.smooth = false;
  const Take noisy = jig_take(0.1);
  EXPECT_LT(motion_left(stabilize(noisy).poses), 0.5 * motion_left(stabilize(noisy, raw).poses));
  // A turn of 3° within two frames is the head's own: a fit over many frames must not round it off.
  Take knock = jig_take(0.02);
  const Eigen::AngleAxisd turn(0.05, Eigen::Vector3d::UnitZ());
  for (int f = 600; f < knock.frames(); ++f)
    for (int m = 0; m < knock.markers(); ++m) knock.set(f, m, turn * knock.at(f, m));
  const Stabilized head = stabilize(knock), single = stabilize(knock, raw);
  for (int f = 590; f < 610; ++f) {
    EXPECT_LT((head.take.at(f, 3) - single.take.at(f, 3)).norm(), 0.3) << f;  // the knock moves it by 60 mm
  }
}

}  // namespace
}  // namespace vultus::mocap
