#include "retarget/simplex_qp.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"

namespace vultus::retarget {
namespace {

Eigen::MatrixXd random_matrix(int rows, int columns, Random& random) {
  Eigen::MatrixXd matrix(rows, columns);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) matrix(r, c) = random.normal();
  }
  return matrix;
}

Eigen::VectorXd random_simplex(int n, Random& random) {
  Eigen::VectorXd weights(n);
  for (int i = 0; i < n; ++i) weights[i] = random.uniform() < 0.5 ? 0.0 : random.uniform();
  weights[random.below(n)] += 0.1;
  return weights / weights.sum();
}

double objective(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& linear, const Eigen::VectorXd& weights) {
  return 0.5 * weights.dot(hessian * weights) + linear.dot(weights);
}

// The answer is exact up to rounding of sums of n products; the contract of the class is 1e-9.
constexpr double kExact = 1e-11;

TEST(SimplexQp, ProjectsOntoTheSimplexByHand) {
  // min ½|w − c|² : (0.8, 0.6, −1) projects to (0.6, 0.4, 0).
  const SimplexQp problem(Eigen::MatrixXd::Identity(3, 3));
  const auto result = problem.solve(-Eigen::Vector3d(0.8, 0.6, -1.0));
  EXPECT_TRUE(result.weights.isApprox(Eigen::Vector3d(0.6, 0.4, 0.0), kExact));
  EXPECT_EQ(result.weights[2], 0.0);
  EXPECT_EQ(result.stopped_because, QpStop::optimal);
}

TEST(SimplexQp, LinearProgrammeTakesTheCheapestPose) {
  const SimplexQp problem(Eigen::MatrixXd::Zero(4, 4));
  const auto result = problem.solve(Eigen::Vector4d(3, 1, 0.5, 2));
  EXPECT_EQ(result.weights, Eigen::Vector4d(0, 0, 1, 0));
}

TEST(SimplexQp, ConstantObjectiveTakesTheFirstPose) {
  const SimplexQp problem(Eigen::MatrixXd::Zero(4, 4));
  EXPECT_EQ(problem.solve(Eigen::Vector4d::Zero()).weights, Eigen::Vector4d(1, 0, 0, 0));
}

TEST(SimplexQp, OneVariable) {
  EXPECT_EQ(SimplexQp(Eigen::MatrixXd::Identity(1, 1)).solve(Eigen::VectorXd::Ones(1)).weights[0], 1.0);
}

TEST(SimplexQp, RandomProblemsSatisfyKkt) {
  Random random(1);
  for (int trial = 0; trial < 2000; ++trial) {
    const int n = 1 + random.below(40);
    const int rows = 1 + random.below(60);
    const Eigen::MatrixXd basis = random_matrix(rows, n, random);
    const Eigen::VectorXd target = random_matrix(rows, 1, random);
    const SimplexQp problem(basis.transpose() * basis);
    const auto result = problem.solve(-basis.transpose() * target);
    ASSERT_EQ(result.stopped_because, QpStop::optimal) << trial;
    ASSERT_LE(result.kkt_residual, kExact) << "trial " << trial << ", " << n << " poses, " << rows << " rows";
    ASSERT_GE(result.weights.minCoeff(), 0.0);
    ASSERT_NEAR(result.weights.sum(), 1.0, 1e-14);
  }
}

TEST(SimplexQp, NoRandomPointOfTheSimplexIsBetter) {
  Random random(2);
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 2 + random.below(12);
    const Eigen::MatrixXd basis = random_matrix(1 + random.below(30), n, random);
    const Eigen::MatrixXd hessian = basis.transpose() * basis;
    const Eigen::VectorXd linear = random_matrix(n, 1, random);
    const double best = objective(hessian, linear, SimplexQp(hessian).solve(linear).weights);
    for (int probe = 0; probe < 50; ++probe) {
      ASSERT_GE(objective(hessian, linear, random_simplex(n, random)), best - 1e-10);
    }
  }
}

TEST(SimplexQp, RecoversTheWeightsOfAnExactTarget) {
  Random random(3);
  for (int trial = 0; trial < 300; ++trial) {
    const Eigen::MatrixXd basis = random_matrix(291, 22, random);
    const Eigen::VectorXd truth = random_simplex(22, random);
    const SimplexQp problem(basis.transpose() * basis);
    const auto result = problem.solve(-basis.transpose() * (basis * truth));
    ASSERT_LE((result.weights - truth).cwiseAbs().maxCoeff(), 1e-10);  // condition of the Gram matrix below 1e4
  }
}

TEST(SimplexQp, WarmAndColdStartsAgree) {
  Random random(4);
  for (int trial = 0; trial < 300; ++trial) {
    const Eigen::MatrixXd basis = random_matrix(60, 22, random);
    const SimplexQp problem(basis.transpose() * basis);
    const Eigen::VectorXd linear = -basis.transpose() * random_matrix(60, 1, random);
    const auto cold = problem.solve(linear);
    const auto warm = problem.solve(linear, random_simplex(22, random));
    const auto hot = problem.solve(linear, cold.weights);
    ASSERT_LE((cold.weights - warm.weights).cwiseAbs().maxCoeff(), 1e-10);
    ASSERT_LE((cold.weights - hot.weights).cwiseAbs().maxCoeff(), 1e-10);
    ASSERT_EQ(hot.iterations, 0);
  }
}

TEST(SimplexQp, DuplicatePosesAndFewRowsStillReachTheOptimum) {
  Random random(5);
  for (int trial = 0; trial < 500; ++trial) {
    const int rows = 1 + random.below(6);
    Eigen::MatrixXd basis = random_matrix(rows, 22, random);
    for (int copy = 0; copy < 8; ++copy) basis.col(random.below(22)) = basis.col(random.below(22));
    basis.col(7).setZero();
    const Eigen::VectorXd target = 3.0 * random_matrix(rows, 1, random);
    const SimplexQp problem(basis.transpose() * basis);
    const Eigen::VectorXd linear = -basis.transpose() * target;
    const auto result = problem.solve(linear);
    ASSERT_EQ(result.stopped_because, QpStop::optimal) << trial;
    ASSERT_LE(result.kkt_residual, kExact) << trial;
    ASSERT_EQ(result.weights, problem.solve(linear).weights);
    ASSERT_LE(problem.solve(linear, random_simplex(22, random)).kkt_residual, kExact) << trial;
  }
}

TEST(SimplexQp, UnboundedDirectionOfASingularMatrixEndsAtABound) {
  // H has rank one and f is not in its range: along the null space only the bounds stop the descent.
  Random random(6);
  for (int trial = 0; trial < 300; ++trial) {
    const Eigen::VectorXd row = random_matrix(10, 1, random);
    const SimplexQp problem(row * row.transpose());
    const auto result = problem.solve(random_matrix(10, 1, random));
    ASSERT_EQ(result.stopped_because, QpStop::optimal);
    ASSERT_LE(result.kkt_residual, kExact);
  }
}

TEST(SimplexQp, ScaleOfTheProblemChangesNothing) {
  Random random(7);
  const Eigen::MatrixXd basis = random_matrix(30, 12, random);
  const Eigen::MatrixXd hessian = basis.transpose() * basis;
  const Eigen::VectorXd linear = random_matrix(12, 1, random);
  const auto plain = SimplexQp(hessian).solve(linear).weights;
  for (double scale : {1e-12, 1e-3, 1e6, 1e12}) {
    const auto scaled = SimplexQp(scale * hessian).solve(scale * linear).weights;
    EXPECT_LE((plain - scaled).cwiseAbs().maxCoeff(), 1e-11) << scale;
  }
}

TEST(SimplexQp, ResidualSeesAWrongAnswer) {
  const Eigen::MatrixXd hessian = Eigen::MatrixXd::Identity(3, 3);
  const Eigen::Vector3d linear(-0.8, -0.6, 1.0);
  EXPECT_LE(kkt_residual(hessian, linear, Eigen::Vector3d(0.6, 0.4, 0.0)), 1e-15);
  EXPECT_GT(kkt_residual(hessian, linear, Eigen::Vector3d(0.5, 0.5, 0.0)), 1e-2);
  EXPECT_GT(kkt_residual(hessian, linear, Eigen::Vector3d(0.7, 0.5, -0.2)), 1e-2);
  EXPECT_GT(kkt_residual(hessian, linear, Eigen::Vector3d(0.6, 0.6, 0.0)), 1e-2);
}

TEST(SimplexQp, RefusesBadInput) {
  EXPECT_THROW(SimplexQp(Eigen::MatrixXd(2, 3)), InputError);
  EXPECT_THROW(SimplexQp(Eigen::MatrixXd(0, 0)), InputError);
  Eigen::MatrixXd broken = Eigen::MatrixXd::Identity(2, 2);
  broken(0, 1) = std::nan("");
  EXPECT_THROW(SimplexQp{broken}, InputError);
  EXPECT_THROW(SimplexQp(Eigen::MatrixXd::Identity(2, 2)).solve(Eigen::Vector3d::Zero()), InputError);
}

}  // namespace
}  // namespace vultus::retarget
