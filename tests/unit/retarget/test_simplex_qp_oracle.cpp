// CGAL's exact rational QP solver as the oracle: integer problems, so that nothing is rounded on its side.
#include <CGAL/Gmpz.h>
#include <CGAL/QP_functions.h>
#include <CGAL/QP_models.h>
#include <gtest/gtest.h>

#include "core/random.h"
#include "retarget/simplex_qp.h"

namespace vultus::retarget {
namespace {

struct IntegerProblem {
  Eigen::MatrixXi hessian;
  Eigen::VectorXi linear;
};

IntegerProblem random_problem(int n, int rows, bool degenerate, Random& random) {
  Eigen::MatrixXi basis(rows, n);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < n; ++c) basis(r, c) = random.below(21) - 10;
  }
  if (degenerate) {
    basis.col(random.below(n)) = basis.col(random.below(n)).eval();
    basis.col(0).setZero();
    basis.row(0) = basis.row(rows - 1).eval();
  }
  Eigen::VectorXi target(rows);
  // A target that is a pose itself makes multipliers vanish: the degenerate vertex.
  if (degenerate && random.below(2) == 0) {
    target = basis.col(random.below(n));
  } else {
    for (int r = 0; r < rows; ++r) target[r] = random.below(41) - 20;
  }
  return {basis.transpose() * basis, -basis.transpose() * target};
}

// min ½wᵀHw + fᵀw over the simplex, exactly; CGAL takes 2D = H and only the lower triangle.
double exact_optimum(const IntegerProblem& problem) {
  using Program = CGAL::Quadratic_program<int>;
  const int n = static_cast<int>(problem.linear.size());
  Program program(CGAL::EQUAL, true, 0, false, 0);
  for (int i = 0; i < n; ++i) {
    program.set_a(i, 0, 1);
    program.set_c(i, problem.linear[i]);
    for (int j = 0; j <= i; ++j) program.set_d(i, j, problem.hessian(i, j));
  }
  program.set_b(0, 1);
  const auto solution = CGAL::solve_quadratic_program(program, CGAL::Gmpz());
  EXPECT_TRUE(solution.is_optimal());
  return CGAL::to_double(solution.objective_value());
}

TEST(SimplexQp, ReachesTheExactOptimumOfCgal) {
  Random random(11);
  for (int trial = 0; trial < 150; ++trial) {
    const int n = 2 + random.below(12);
    const int rows = 2 + random.below(20);
    const IntegerProblem problem = random_problem(n, rows, trial % 2 == 1, random);
    const Eigen::MatrixXd hessian = problem.hessian.cast<double>();
    const Eigen::VectorXd linear = problem.linear.cast<double>();
    const SimplexQpResult ours = SimplexQp(hessian).solve(linear);
    const double objective = 0.5 * ours.weights.dot(hessian * ours.weights) + linear.dot(ours.weights);
    const double exact = exact_optimum(problem);
    const double scale = hessian.diagonal().maxCoeff() + linear.cwiseAbs().maxCoeff();
    ASSERT_NEAR(objective, exact, 1e-12 * scale) << "trial " << trial << ": " << n << " poses, " << rows << " rows";
  }
}

}  // namespace
}  // namespace vultus::retarget
