#include "mocap/rigid_body.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/statistics.h"

namespace vultus::mocap {

namespace {

constexpr double kFar = 5.0;               // times the median distance from the middle: no marker of a head
constexpr double kBiweightTuning = 4.685;  // 95 % efficiency on Gaussian noise
// Length of a residual in three dimensions whose median is one deviation of a coordinate: sqrt of chi²(3)'s median.
constexpr double kMedianLength = 1.538;

struct Seen {
  Points body, world;
  Eigen::VectorXd deviations;
};

Seen seen_rows(const RigidBody& body, const Points& observed) {
  std::vector<int> rows;
  for (int m = 0; m < observed.rows(); ++m) {
    if (observed.row(m).allFinite() && body.positions.row(m).allFinite()) rows.push_back(m);
  }
  const auto n = static_cast<Eigen::Index>(rows.size());
  Seen seen{Points(n, 3), Points(n, 3), Eigen::VectorXd(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    seen.body.row(i) = body.positions.row(rows[static_cast<std::size_t>(i)]);
    seen.world.row(i) = observed.row(rows[static_cast<std::size_t>(i)]);
    seen.deviations(i) = body.deviations(rows[static_cast<std::size_t>(i)]);
  }
  return seen;
}

std::optional<Similarity> weighted_fit(const Seen& seen, const Eigen::VectorXd& weights) {
  try {
    return fit_similarity(seen.body, seen.world, Scaling::fixed, weights);
  } catch (const InputError&) {  // collinear markers: no pose
    return {};
  }
}

Eigen::VectorXd scaled_residuals(const Seen& seen, const Similarity& world_from_body) {
  return (transformed(world_from_body, seen.body) - seen.world).rowwise().norm().cwiseQuotient(seen.deviations);
}

/// Among all triples (few markers only), the fit with the least median scaled residual.
std::optional<Similarity> least_median_start(const Seen& seen) {
  const auto n = seen.body.rows();
  std::optional<Similarity> best;
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = a + 1; b < n; ++b) {
      for (Eigen::Index c = b + 1; c < n; ++c) {
        Eigen::VectorXd weights = Eigen::VectorXd::Zero(n);
        weights(a) = weights(b) = weights(c) = 1.0;
        const auto fit = weighted_fit(seen, weights);
        if (!fit) continue;
        const double middle = quantile(scaled_residuals(seen, *fit), 0.5 + 0.5 / static_cast<double>(n));
        if (middle < least) {
          least = middle;
          best = fit;
        }
      }
    }
  }
  return best;
}

/// Tukey weights of scaled residuals; the scale grows with their median, never below the stated deviations.
Eigen::VectorXd biweights(const Eigen::VectorXd& residuals) {
  const double scale = std::max(1.0, quantile(residuals, 0.5) / kMedianLength);
  const Eigen::ArrayXd u = residuals.array() / (kBiweightTuning * scale * std::sqrt(3.0));
  return (u < 1.0).select((1.0 - u.square()).square(), 0.0);
}

/// Rows of a point's small motion by turn (radians) and shift.
Eigen::Matrix<double, 3, 6> motion_of(const Eigen::Vector3d& p) {
  Eigen::Matrix<double, 3, 6> moved;
  moved << 0, p.z(), -p.y(), 1, 0, 0, -p.z(), 0, p.x(), 0, 1, 0, p.y(), -p.x(), 0, 0, 0, 1;
  return moved;
}

/// Expected RMS error over all markers of the body: the pose's covariance by linear propagation.
double expected_error(const RigidBody& body, const Seen& seen, const Eigen::VectorXd& weights) {
  const Eigen::Vector3d middle = seen.body.colwise().mean();
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero(), metric = information;
  for (Eigen::Index i = 0; i < seen.body.rows(); ++i) {
    const auto moved = motion_of(Eigen::Vector3d(seen.body.row(i)) - middle);
    information += weights[i] * moved.transpose() * moved;
  }
  int rows = 0;
  for (Eigen::Index m = 0; m < body.positions.rows(); ++m) {
    if (!body.positions.row(m).allFinite()) continue;
    const auto moved = motion_of(Eigen::Vector3d(body.positions.row(m)) - middle);
    metric += moved.transpose() * moved;
    ++rows;
  }
  const Eigen::Matrix<double, 6, 6> spread = information.ldlt().solve(metric);
  return std::sqrt(std::max(0.0, spread.trace() / rows));
}

/// Median place of one marker over the frames, in head coordinates, and how far it strays from there.
void settle_marker(const std::vector<Points>& in_head, Eigen::Index row, RigidBody& body) {
  std::vector<double> values;
  for (int c = 0; c < 3; ++c) {
    values.clear();
    for (const Points& points : in_head) {
      if (points.rows() > 0 && points.row(row).allFinite()) values.push_back(points(row, c));
    }
    if (values.empty()) return;
    body.positions(row, c) = quantile(values, 0.5);
  }
  values.clear();
  for (const Points& points : in_head) {
    if (points.rows() > 0 && points.row(row).allFinite()) {
      values.push_back((points.row(row) - body.positions.row(row)).norm());
    }
  }
  // A high quantile, since a face rests most of the time and moves in bursts; 2.154 is chi(3)'s 80 % point.
  body.deviations(row) = std::max(0.02, quantile(values, 0.8) / 2.154);
}

}  // namespace

std::optional<HeadPose> fit_body(const RigidBody& body, const Points& observed) {
  constexpr int max_iterations = 20;
  constexpr Eigen::Index few = 9;  // up to 84 triples
  const Seen seen = seen_rows(body, observed);
  if (seen.body.rows() < 3) return {};
  const Eigen::VectorXd base = seen.deviations.cwiseAbs2().cwiseInverse();
  auto fit = weighted_fit(seen, base);
  if (!fit) return {};
  Eigen::VectorXd residuals = scaled_residuals(seen, *fit), robust = Eigen::VectorXd::Ones(base.size());
  if (base.size() > 3 && base.size() <= few && residuals.maxCoeff() > kBiweightTuning) {
    if (const auto start = least_median_start(seen)) residuals = scaled_residuals(seen, *start);
  }
  for (int iteration = 0; iteration < max_iterations && base.size() > 3; ++iteration) {
    const Eigen::VectorXd weights = biweights(residuals);
    const double change = (weights - robust).cwiseAbs().maxCoeff();
    if ((weights.array() > 0.0).count() < 3) break;
    const auto next = weighted_fit(seen, base.cwiseProduct(weights));
    if (!next) break;
    fit = next;
    robust = weights;
    residuals = scaled_residuals(seen, *fit);
    if (change < 1e-3) break;
  }
  const Eigen::VectorXd squares = residuals.cwiseProduct(seen.deviations).cwiseAbs2();
  HeadPose pose;
  pose.kind = HeadPose::Kind::measured;
  pose.world_from_head = *fit;
  pose.rms = std::sqrt(robust.dot(squares) / robust.sum());
  pose.markers = static_cast<int>((robust.array() > 0.0).count());
  pose.deviation = expected_error(body, seen, base.cwiseProduct(robust));
  return pose;
}

std::vector<int> columns_of(const Take& take, const std::vector<std::string>& labels) {
  std::vector<int> columns;
  for (const std::string& label : labels) columns.push_back(take.find(label));
  return columns;
}

Points observed_rows(const Take& take, int frame, const std::vector<int>& columns) {
  Points rows =
      Points::Constant(static_cast<Eigen::Index>(columns.size()), 3, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i] >= 0 && take.has(frame, columns[i])) {
      rows.row(static_cast<Eigen::Index>(i)) = take.at(frame, columns[i]).transpose();
    }
  }
  return rows;
}

std::vector<Eigen::Index> rows_together(const Points& markers) {
  Eigen::RowVector3d middle;
  for (int c = 0; c < 3; ++c) middle[c] = quantile(Eigen::VectorXd(markers.col(c)), 0.5);
  const Eigen::VectorXd away = (markers.rowwise() - middle).rowwise().norm();
  const double far = kFar * quantile(away, 0.5);
  std::vector<Eigen::Index> rows;
  for (Eigen::Index m = 0; m < markers.rows(); ++m)
    if (away[m] <= far) rows.push_back(m);
  return rows;
}

RigidBody refine_body(const Take& take, const RigidBody& body, int reference_frame, const std::vector<int>& frames) {
  constexpr int rounds = 4;
  const std::vector<int> columns = columns_of(take, body.labels);
  RigidBody result = body;
  for (int round = 0; round < rounds; ++round) {
    std::vector<Points> in_head(frames.size());
    tbb::parallel_for(std::size_t{0}, frames.size(), [&](std::size_t i) {
      const Points observed = observed_rows(take, frames[i], columns);
      if (const auto pose = fit_body(result, observed))
        in_head[i] = transformed(pose->world_from_head.inverse(), observed);
    });
    for (Eigen::Index row = 0; row < body.positions.rows(); ++row) settle_marker(in_head, row, result);
  }
  const Points anchor = observed_rows(take, reference_frame, columns);
  if (const auto pose = fit_body(result, anchor))
    result.positions = transformed(pose->world_from_head, result.positions);
  return result;
}

std::vector<HeadPose> body_poses(const Take& take, const RigidBody& body) {
  const std::vector<int> columns = columns_of(take, body.labels);
  std::vector<HeadPose> poses(static_cast<std::size_t>(take.frames()));
  tbb::parallel_for(0, take.frames(), [&](int f) {
    if (const auto pose = fit_body(body, observed_rows(take, f, columns))) poses[static_cast<std::size_t>(f)] = *pose;
  });
  return poses;
}

}  // namespace vultus::mocap
