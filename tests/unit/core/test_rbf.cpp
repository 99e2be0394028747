#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "core/rbf.h"

namespace vultus {
namespace {

Points cloud(int n, std::uint64_t seed, double size = 100) {
  Random random(seed);
  Points points(n, 3);
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < 3; ++k) points(i, k) = random.uniform(-size, size);
  return points;
}

Points affine_image(const Points& points) {
  Eigen::Matrix3d a;
  a << 1.1, 0.2, -0.1, 0.05, 0.9, 0.3, -0.2, 0.1, 1.3;
  return (points * a.transpose()).rowwise() + Eigen::RowVector3d(5, -7, 40);
}

std::string refusal(const Points& source, const Points& target, const RbfMap::Options& options = {}) {
  try {
    const RbfMap map(source, target, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Rbf, TwoCentresByHand) {
  // Zhu eq. 4.1 with centres 3 mm apart on x: radii 3, H = [[3, 3√2], [3√2, 3]]. A target of 1 at the first centre and
  // 0 at the second gives w = (-1/3, √2/3), so that F(0.5, …) = w·(H(x, x1), H(x, x2)).
  Points source(2, 3), target(2, 3);
  source << 0, 0, 0, 3, 0, 0;
  target << 1, 0, 0, 0, 0, 0;
  const RbfMap map(source, target, {RbfKernel::multiquadric, false, 0.0});
  const Eigen::Vector3d x(1, 2, 2);
  const double expected = -1.0 / 3 * std::sqrt(9 + 9.0) + std::sqrt(2.0) / 3 * std::sqrt(4 + 4 + 4 + 9.0);
  EXPECT_NEAR((map(x) - Eigen::Vector3d(expected, 0, 0)).norm(), 0, 1e-12);
}

TEST(Rbf, InverseMultiquadricByHand) {
  // φ = [[1/3, 1/(3√2)], …]; det = 1/18, so w = 18·(1/3, -1/(3√2)).
  Points source(2, 3), target(2, 3);
  source << 0, 0, 0, 3, 0, 0;
  target << 1, 0, 0, 0, 0, 0;
  const RbfMap map(source, target, {RbfKernel::inverse_multiquadric, false, 0.0});
  const Eigen::Vector3d x(1, 2, 2);
  const double expected = 6 / std::sqrt(18.0) - 6 / std::sqrt(2.0) / std::sqrt(21.0);
  EXPECT_NEAR((map(x) - Eigen::Vector3d(expected, 0, 0)).norm(), 0, 1e-12);
}

class RbfKernels : public testing::TestWithParam<RbfKernel> {};

TEST_P(RbfKernels, InterpolatesItsPairs) {
  const Points source = cloud(172, 1), target = cloud(172, 2);
  for (const bool affine : {true, false}) {
    const RbfMap map(source, target, {GetParam(), affine, 0.0});
    EXPECT_LT((map(source) - target).cwiseAbs().maxCoeff(), 1e-7);  // 172 centres: condition numbers reach 1e6
    EXPECT_LT(map.max_residual(), 1e-7);
  }
}

TEST_P(RbfKernels, AffineTermReproducesAffineMapsEverywhere) {
  // The side conditions (Sánchez eq. 14) leave the whole of an affine map to the affine term, so it extrapolates too.
  const Points source = cloud(40, 3), elsewhere = cloud(40, 4, 500);
  const RbfMap map(source, affine_image(source), {GetParam(), true, 0.0});
  EXPECT_LT((map(elsewhere) - affine_image(elsewhere)).cwiseAbs().maxCoeff(), 1e-8);
}

TEST_P(RbfKernels, FollowsMotionOfTheWholeProblem) {
  const Points source = cloud(30, 5), target = cloud(30, 6), probe = cloud(10, 7);
  const Eigen::RowVector3d shift(1000, -2000, 500);
  const RbfMap here(source, target, {GetParam(), true, 0.0});
  const RbfMap there(source.rowwise() + shift, target.rowwise() + shift, {GetParam(), true, 0.0});
  EXPECT_LT((there(Points(probe.rowwise() + shift)) - (here(probe).rowwise() + shift)).cwiseAbs().maxCoeff(), 1e-7);
}

TEST_P(RbfKernels, DoesNotDependOnTheUnit) {
  const Points source = cloud(30, 5), target = cloud(30, 6), probe = cloud(10, 7);
  const RbfMap millimetres(source, target, {GetParam(), true, 0.0});
  const RbfMap metres(source * 1e-3, target * 1e-3, {GetParam(), true, 0.0});
  EXPECT_LT((1e3 * metres(Points(probe * 1e-3)) - millimetres(probe)).cwiseAbs().maxCoeff(), 1e-7);
}

INSTANTIATE_TEST_SUITE_P(Both, RbfKernels, testing::Values(RbfKernel::multiquadric, RbfKernel::inverse_multiquadric));

TEST(Rbf, SmoothingTradesResidualForCloseness) {
  const Points source = cloud(30, 5), target = source + cloud(30, 6, 2);
  const RbfMap exact(source, target, {RbfKernel::inverse_multiquadric, true, 0.0});
  const RbfMap smooth(source, target, {RbfKernel::inverse_multiquadric, true, 0.05});
  EXPECT_LT(exact.max_residual(), 1e-9);
  EXPECT_GT(smooth.max_residual(), 0.01);
  EXPECT_LT(smooth.max_residual(), 5.0);  // never further than the disturbance itself
}

TEST(Rbf, RefusesWhatHasNoAnswer) {
  Points source = cloud(10, 1);
  const Points target = cloud(10, 2);
  source.row(7) = source.row(2);
  EXPECT_NE(refusal(source, target).find("rows 2 and 7"), std::string::npos);
  source = cloud(10, 1);
  EXPECT_NE(refusal(source, target.topRows(9)).find("pair up"), std::string::npos);
  EXPECT_NE(refusal(source.topRows(3), target.topRows(3)).find("at least 4"), std::string::npos);
  EXPECT_NE(refusal(source, target, {RbfKernel::multiquadric, true, -1.0}).find("smoothing"), std::string::npos);
  source(4, 1) = std::nan("");
  EXPECT_NE(refusal(source, target).find("row 4"), std::string::npos);
  source = cloud(10, 1);
  source.col(2).setConstant(12.0);
  EXPECT_NE(refusal(source, target).find("plane"), std::string::npos);
  EXPECT_EQ(refusal(source, target, {RbfKernel::multiquadric, false, 0.0}), "accepted");
}

}  // namespace
}  // namespace vultus
