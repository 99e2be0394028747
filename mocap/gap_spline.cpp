#include <Eigen/QR>
#include <algorithm>

#include "mocap/gap_methods.h"

namespace vultus::mocap {

namespace {

/// Velocity in mm a frame at `end`, from the samples on its side away from the gap (`step` -1: before it, +1: after).
Eigen::Vector3d end_velocity(const TakeView& view, int marker, int end, int step, int window) {
  std::vector<int> frames;
  for (int i = 0; i < window && view.has(end + i * step, marker); ++i) frames.push_back(end + i * step);
  if (frames.size() < 2) return Eigen::Vector3d::Zero();
  const Eigen::Index n = static_cast<Eigen::Index>(frames.size()), terms = n >= 3 ? 3 : 2;
  Eigen::MatrixXd powers(n, terms), values(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double t = frames[static_cast<std::size_t>(i)] - end;
    powers(i, 0) = 1.0;
    powers(i, 1) = t;
    if (terms == 3) powers(i, 2) = t * t;
    values.row(i) = view.at(frames[static_cast<std::size_t>(i)], marker).transpose();
  }
  return powers.colPivHouseholderQr().solve(values).row(1).transpose();
}

}  // namespace

std::optional<Points> spline_fill(const TakeView& view, const Gap& gap, int window) {
  const int before = gap.first - 1, after = gap.last + 1;
  const bool left = view.has(before, gap.marker), right = view.has(after, gap.marker);
  if (!left && !right) return {};
  Points filled(gap.frames(), 3);
  if (!left || !right) {
    filled.rowwise() = view.at(left ? before : after, gap.marker).transpose();
    return filled;
  }
  const double span = after - before;
  const Eigen::Vector3d p0 = view.at(before, gap.marker), p1 = view.at(after, gap.marker);
  const Eigen::Vector3d v0 = span * end_velocity(view, gap.marker, before, -1, window);
  const Eigen::Vector3d v1 = span * end_velocity(view, gap.marker, after, 1, window);
  for (int i = 0; i < gap.frames(); ++i) {
    const double t = (i + 1) / span, u = 1.0 - t;
    const Eigen::Vector3d p =
        u * u * (1.0 + 2.0 * t) * p0 + t * u * u * v0 + t * t * (3.0 - 2.0 * t) * p1 - t * t * u * v1;
    filled.row(i) = p.transpose();
  }
  return filled;
}

}  // namespace vultus::mocap
