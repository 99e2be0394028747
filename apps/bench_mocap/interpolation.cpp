#include "apps/bench_mocap/interpolation.h"

#include <Eigen/LU>
#include <cmath>

namespace vultus::apps::bench_mocap {

namespace {

/// Slope that PCHIP gives a knot between chords of slopes `a` and `b` over `ha` and `hb`.
double pchip_slope(double a, double b, double ha, double hb) {
  if (a * b <= 0.0) return 0.0;
  const double wa = 2.0 * hb + ha, wb = hb + 2.0 * ha;
  return (wa + wb) / (wa / a + wb / b);
}

Points linear(const Points& before, const Points& after, int length) {
  Points filled(length, 3);
  for (int i = 0; i < length; ++i) {
    const double t = (i + 1.0) / (length + 1.0);
    filled.row(i) = (1.0 - t) * before.row(before.rows() - 1) + t * after.row(0);
  }
  return filled;
}

Points pchip(const Points& before, const Points& after, int length) {
  const Eigen::Index last = before.rows() - 1;
  const double span = length + 1.0;
  Points filled(length, 3);
  for (int c = 0; c < 3; ++c) {
    const double p0 = before(last, c), p1 = after(0, c), chord = (p1 - p0) / span;
    const double s0 = pchip_slope(p0 - before(last - 1, c), chord, 1.0, span);
    const double s1 = pchip_slope(chord, after(1, c) - p1, span, 1.0);
    for (int i = 0; i < length; ++i) {
      const double t = (i + 1.0) / span, u = 1.0 - t;
      filled(i, c) =
          u * u * (1.0 + 2.0 * t) * p0 + span * t * u * u * s0 + t * t * (3.0 - 2.0 * t) * p1 - span * t * t * u * s1;
    }
  }
  return filled;
}

/// Knots at every sample given; second derivatives from the tridiagonal system, zero at both ends.
Points natural_cubic(const Points& before, const Points& after, int length) {
  const Eigen::Index left = before.rows(), n = left + after.rows();
  Points knots(n, 3);
  knots << before, after;
  Eigen::VectorXd steps = Eigen::VectorXd::Ones(n - 1);
  steps(left - 1) = length + 1.0;
  Eigen::MatrixXd system = Eigen::MatrixXd::Identity(n, n);
  Points right = Points::Zero(n, 3);
  for (Eigen::Index i = 1; i + 1 < n; ++i) {
    system.row(i).segment<3>(i - 1) << steps(i - 1), 2.0 * (steps(i - 1) + steps(i)), steps(i);
    right.row(i) =
        6.0 * ((knots.row(i + 1) - knots.row(i)) / steps(i) - (knots.row(i) - knots.row(i - 1)) / steps(i - 1));
  }
  const Points second = system.partialPivLu().solve(Eigen::MatrixXd(right));
  const double h = steps(left - 1);
  Points filled(length, 3);
  for (int i = 0; i < length; ++i) {
    const double a = i + 1.0, b = h - a;
    filled.row(i) = (second.row(left - 1) * b * b * b + second.row(left) * a * a * a) / (6.0 * h) +
                    (knots.row(left - 1) / h - second.row(left - 1) * h / 6.0) * b +
                    (knots.row(left) / h - second.row(left) * h / 6.0) * a;
  }
  return filled;
}

}  // namespace

std::array<Points, 3> interpolations(const Points& before, const Points& after, int length) {
  return {linear(before, after, length), pchip(before, after, length), natural_cubic(before, after, length)};
}

}  // namespace vultus::apps::bench_mocap
