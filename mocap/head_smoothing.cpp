#include "mocap/head_smoothing.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/statistics.h"

namespace vultus::mocap {

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;  // turn (radians), then shift (mm), seen from the frame's own pose
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Powers = std::array<double, 2 * 6 + 1>;  // sums of the powers of time
using Moments = Eigen::Matrix<double, 7, 6>;   // the same times the changes of pose

/// A width and the degree of its polynomial in time; the first stands for the pose as it is.
struct Width {
  int half, degree;  // frames
};
constexpr std::array<Width, 12> kWidthList = {
    {{0, 0}, {2, 2}, {4, 2}, {7, 2}, {11, 2}, {16, 2}, {22, 2}, {34, 4}, {42, 4}, {52, 6}, {64, 6}, {78, 6}}};
constexpr int kMostDegree = 6;
constexpr int kWidest = kWidthList.back().half;
constexpr std::size_t kWidths = kWidthList.size();
constexpr double kMostNoise = 16.0;  // squared; a pose that the fit would move further is no noise but a knock
constexpr double kDecideSeconds = 1.0;

/// Mean square of how far the body's markers are moved by a small change of pose: change' M change.
Matrix6 body_metric(const RigidBody& body) {
  Matrix6 metric = Matrix6::Zero();
  int n = 0;
  for (Eigen::Index m = 0; m < body.positions.rows(); ++m) {
    if (!body.positions.row(m).allFinite()) continue;
    const Eigen::Vector3d p = body.positions.row(m);
    Eigen::Matrix<double, 3, 6> moved;
    moved << 0, p.z(), -p.y(), 1, 0, 0, -p.z(), 0, p.x(), 0, 1, 0, p.y(), -p.x(), 0, 0, 0, 1;
    metric += moved.transpose() * moved;
    ++n;
  }
  return metric / std::max(1, n);
}

/// `pose` in the coordinates of `own`; the inverse of `changed`.
Vector6 change(const Similarity& own, const Similarity& pose) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(own.rotation.transpose() * pose.rotation));
  Vector6 result;
  result << turn.angle() * turn.axis(), own.rotation.transpose() * (pose.translation - own.translation);
  return result;
}

Similarity changed(const Similarity& own, const Vector6& by) {
  const double angle = by.head<3>().norm();
  Similarity result = own;
  if (angle > 0.0) result.rotation = own.rotation * Eigen::AngleAxisd(angle, by.head<3>() / angle).toRotationMatrix();
  result.translation = own.translation + own.rotation * by.tail<3>();
  return result;
}

/// What the fits of all widths say about one frame.
struct Fits {
  std::array<Vector6, kWidths> change;      // of the pose
  std::array<double, kWidths> miss_square;  // mm², of the prediction without the frame itself; NaN without one
  std::array<double, kWidths> variance;     // of the fit, in units of a pose of weight one
};

class Smoothing {
 public:
  Smoothing(const std::vector<HeadPose>& poses, const RigidBody& body)
      : poses_(poses), metric_(body_metric(body)), unseen_noise_(unseen_noise(body)), weights_(poses.size()) {
    for (std::size_t f = 0; f < poses.size(); ++f) {
      const double deviation = std::max(poses[f].deviation, 1e-4);
      weights_[f] = poses[f].kind == HeadPose::Kind::measured ? 1.0 / (deviation * deviation) : 0.0;
    }
  }

  std::vector<HeadPose> run(double rate_hz) {
    fit_all();
    const std::vector<double> width = widths(std::max(2, static_cast<int>(kDecideSeconds * rate_hz)));
    std::vector<HeadPose> result = poses_;
    tbb::parallel_for(std::size_t{0}, poses_.size(), [&](std::size_t f) {
      if (poses_[f].kind == HeadPose::Kind::none) return;
      const auto low = std::min(static_cast<std::size_t>(width[f]), kWidths - 2);
      const double t = width[f] - static_cast<double>(low);
      const Vector6 by = (1.0 - t) * fits_[f].change[low] + t * fits_[f].change[low + 1];
      if (poses_[f].kind == HeadPose::Kind::measured && by.dot(metric_ * by) > kMostNoise * noise_square(f)) return;
      result[f].world_from_head = changed(poses_[f].world_from_head, by);
    });
    return result;
  }

 private:
  static double unseen_noise(const RigidBody& body) {
    const auto n = static_cast<double>((body.positions.rowwise().sum().array().isFinite()).count());
    return n > 3.0 ? n / (n - 2.0) : 3.0;
  }

  void fit_all() {
    fits_.resize(poses_.size());
    tbb::parallel_for(0, static_cast<int>(poses_.size()), [&](int f) { fits_[static_cast<std::size_t>(f)] = fits(f); });
  }

  Fits fits(int f) const {
    Fits result;
    result.change.fill(Vector6::Zero());
    result.miss_square.fill(std::numeric_limits<double>::quiet_NaN());
    result.variance.fill(1.0);
    if (poses_[static_cast<std::size_t>(f)].kind == HeadPose::Kind::none) return result;
    const int first = std::max(0, f - kWidest), last = std::min(static_cast<int>(poses_.size()) - 1, f + kWidest);
    std::array<Vector6, 2 * kWidest + 1> changes;
    const Similarity& own = poses_[static_cast<std::size_t>(f)].world_from_head;
    for (int g = first; g <= last; ++g) {
      const auto i = static_cast<std::size_t>(g);
      if (weights_[i] > 0.0) changes[static_cast<std::size_t>(g - first)] = change(own, poses_[i].world_from_head);
    }
    Powers powers{};
    Moments moments = Moments::Zero();
    int reach = -1, seen = 0;
    for (std::size_t w = 1; w < kWidths; ++w) {
      for (++reach; reach <= kWidthList[w].half; ++reach) {
        for (const int g : {f - reach, f + reach}) {
          if (g < first || g > last || (reach == 0 && g != f) || weights_[static_cast<std::size_t>(g)] <= 0.0) continue;
          const double u = static_cast<double>(g - f) / kWidest;
          double power = weights_[static_cast<std::size_t>(g)];
          for (std::size_t k = 0; k < powers.size(); ++k, power *= u) {
            powers[k] += power;
            if (k > kMostDegree) continue;
            moments.row(static_cast<Eigen::Index>(k)) +=
                power * changes[static_cast<std::size_t>(g - first)].transpose();
          }
          ++seen;
          if (reach == 0) break;
        }
      }
      reach = kWidthList[w].half;
      settle(f, w, seen, powers, moments, result);
    }
    return result;
  }

  /// The polynomial's value at the frame, and how far it is off when the frame itself is left out.
  void settle(int f, std::size_t w, int seen, const Powers& powers, const Moments& moments, Fits& result) const {
    result.change[w] = result.change[w - 1];
    result.variance[w] = result.variance[w - 1];
    const Eigen::Index n = kWidthList[w].degree + 1;
    if (seen < n + 2) return;
    Eigen::MatrixXd normal(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < n; ++j) normal(i, j) = powers[static_cast<std::size_t>(i + j)];
    const auto factors = normal.ldlt();
    if (factors.info() != Eigen::Success || factors.rcond() < 1e-14) return;
    const Eigen::VectorXd row = factors.solve(Eigen::VectorXd::Unit(n, 0));
    result.change[w] = moments.topRows(n).transpose() * row;
    result.variance[w] = row[0];
    const double weight = weights_[static_cast<std::size_t>(f)], leverage = weight * row[0];
    if (weight <= 0.0 || leverage > 0.95) return;
    const Vector6 miss = result.change[w] / (1.0 - leverage);
    result.miss_square[w] = miss.dot(metric_ * miss);
  }

  /// A single pose's own error; residuals of n markers show only (n - 2) / n of their noise, six unknowns being fitted.
  double noise_square(std::size_t f) const { return unseen_noise_ * poses_[f].deviation * poses_[f].deviation; }

  /// Sums up to each frame, so that means over a stretch are differences.
  struct Sums {
    std::array<std::vector<double>, kWidths> miss, variance;
    std::vector<double> count, noise;
  };
  Sums sums() const {
    const std::size_t n = poses_.size();
    Sums s;
    for (auto* list : {&s.miss, &s.variance})
      for (auto& values : *list) values.assign(n + 1, 0.0);
    s.count.assign(n + 1, 0.0);
    s.noise.assign(n + 1, 0.0);
    for (std::size_t f = 0; f < n; ++f) {
      bool all = weights_[f] > 0.0;
      for (std::size_t w = 1; w < kWidths; ++w) all = all && std::isfinite(fits_[f].miss_square[w]);
      const double one = all ? 1.0 : 0.0;
      s.count[f + 1] = s.count[f] + one;
      s.noise[f + 1] = s.noise[f] + one * noise_square(f) * weights_[f];
      // A pose predicted from others misses by its own noise and the prediction's error; unsmoothed it has its noise.
      s.miss[0][f + 1] = s.miss[0][f] + (all ? 2.0 * noise_square(f) : 0.0);
      for (std::size_t w = 1; w < kWidths; ++w) {
        s.miss[w][f + 1] = s.miss[w][f] + (all ? fits_[f].miss_square[w] : 0.0);
        s.variance[w][f + 1] = s.variance[w][f] + one * fits_[f].variance[w];
      }
    }
    return s;
  }

  /// Number of the width (between two where they change) for each frame.
  std::vector<double> widths(int reach) const {
    const std::size_t n = poses_.size();
    const Sums s = sums();
    std::vector<double> chosen(n, 0.0);
    for (std::size_t f = 0; f < n; ++f) {
      const std::size_t a = f > static_cast<std::size_t>(reach) ? f - static_cast<std::size_t>(reach) : 0;
      const std::size_t b = std::min(n, f + static_cast<std::size_t>(reach) + 1);
      const auto mean = [&](const std::vector<double>& total) {
        return (total[b] - total[a]) / (s.count[b] - s.count[a]);
      };
      if (s.count[b] - s.count[a] < 5.0) continue;
      std::size_t best = 0;
      double least = mean(s.miss[0]);
      for (std::size_t w = 1; w < kWidths; ++w) {
        // Beside holes and at the take's ends a fit is worse than those around it say.
        const double worse = mean(s.noise) * std::max(0.0, fits_[f].variance[w] - mean(s.variance[w]));
        if (mean(s.miss[w]) + worse >= least) continue;
        least = mean(s.miss[w]) + worse;
        best = w;
      }
      chosen[f] = static_cast<double>(best);
    }
    return running_mean(chosen, reach / 2);
  }

  static std::vector<double> running_mean(const std::vector<double>& values, int reach) {
    std::vector<double> sums(values.size() + 1, 0.0), result(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) sums[i + 1] = sums[i] + values[i];
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::size_t a = i > static_cast<std::size_t>(reach) ? i - static_cast<std::size_t>(reach) : 0;
      const std::size_t b = std::min(values.size(), i + static_cast<std::size_t>(reach) + 1);
      result[i] = (sums[b] - sums[a]) / static_cast<double>(b - a);
    }
    return result;
  }

  const std::vector<HeadPose>& poses_;
  Matrix6 metric_;
  double unseen_noise_;
  std::vector<double> weights_;
  std::vector<Fits> fits_;
};

}  // namespace

std::vector<HeadPose> smoothed_poses(const std::vector<HeadPose>& poses, const RigidBody& body, double rate_hz) {
  if (poses.size() < 5) return poses;
  return Smoothing(poses, body).run(rate_hz);
}

}  // namespace vultus::mocap
