#include "mocap/layout_fit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/random.h"
#include "core/statistics.h"
#include "mocap/assignment.h"
#include "mocap/steady_markers.h"
#include "mocap/tracklets.h"

namespace vultus::mocap {

namespace {

constexpr int kTriples = 40;
constexpr int kNeighbours = 6;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Markers near a place count more than those just within the gate.
double closeness(const RigidBody& layout, const Eigen::VectorXd& gate, const Points& points, const Similarity& pose) {
  double sum = 0.0;
  for (Eigen::Index m = 0; m < layout.positions.rows(); ++m) {
    const Eigen::RowVector3d at = (pose * Eigen::Vector3d(layout.positions.row(m))).transpose();
    sum += std::max(0.0, 1.0 - (points.rowwise() - at).rowwise().squaredNorm().minCoeff() / (gate[m] * gate[m]));
  }
  return sum;
}

/// Where each marker is expected, in layout coordinates: moved by the median displacement of its nearest seen
/// neighbours.
Points displaced(const RigidBody& layout, const Points& seen) {
  Points result = layout.positions;
  for (Eigen::Index m = 0; m < result.rows(); ++m) {
    std::vector<std::pair<double, Eigen::Index>> near;
    for (Eigen::Index k = 0; k < result.rows(); ++k) {
      if (k == m || !seen.row(k).allFinite()) continue;
      near.emplace_back((layout.positions.row(k) - layout.positions.row(m)).squaredNorm(), k);
    }
    if (near.size() < kNeighbours) continue;
    std::partial_sort(near.begin(), near.begin() + kNeighbours, near.end());
    for (int c = 0; c < 3; ++c) {
      std::vector<double> moves;
      for (int i = 0; i < kNeighbours; ++i) {
        const Eigen::Index k = near[static_cast<std::size_t>(i)].second;
        moves.push_back(seen(k, c) - layout.positions(k, c));
      }
      result(m, c) += median(std::move(moves));
    }
  }
  return result;
}

Points matched_rows(const Points& points, const std::vector<int>& match) {
  Points rows = Points::Constant(static_cast<Eigen::Index>(match.size()), 3, kNaN);
  for (std::size_t m = 0; m < match.size(); ++m)
    if (match[m] >= 0) rows.row(static_cast<Eigen::Index>(m)) = points.row(match[m]);
  return rows;
}

/// One-to-one; each marker may stay without a point at the price of a point on its gate.
std::vector<int> assigned(const Points& expected, const Eigen::VectorXd& gate, const Points& points) {
  const Eigen::Index n = expected.rows(), count = points.rows();
  Eigen::MatrixXd cost = Eigen::MatrixXd::Ones(n, count + n);
  for (Eigen::Index m = 0; m < n; ++m) {
    cost.row(m).head(count) =
        ((points.rowwise() - expected.row(m)).rowwise().squaredNorm() / (gate[m] * gate[m])).cwiseMin(10.0).transpose();
  }
  std::vector<int> match = least_cost_assignment(cost);
  for (Eigen::Index m = 0; m < n; ++m) {
    int& point = match[static_cast<std::size_t>(m)];
    if (point >= count || cost(m, point) >= 1.0) point = -1;
  }
  return match;
}

}  // namespace

RigidBody marker_layout(const Take& labelled) {
  RigidBody body;
  std::vector<int> columns;
  for (int c = 0; c < labelled.markers(); ++c)
    if (!is_unlabelled(labelled.labels[static_cast<std::size_t>(c)])) columns.push_back(c);
  if (columns.size() < 8 || labelled.frames() < 1) {
    throw InputError("take '" + labelled.name + "' has " + std::to_string(columns.size()) +
                     " labelled markers; labels are taken from a take with eight or more");
  }
  const auto count = [&](int f) {
    return std::count_if(columns.begin(), columns.end(), [&](int c) { return labelled.has(f, c); });
  };
  int reference = 0;
  for (int f = 1; f < labelled.frames(); ++f)
    if (count(f) > count(reference)) reference = f;
  for (const int c : columns)
    if (labelled.has(reference, c)) body.labels.push_back(labelled.labels[static_cast<std::size_t>(c)]);
  body.positions = observed_rows(labelled, reference, columns_of(labelled, body.labels));
  body.deviations = Eigen::VectorXd::Ones(body.positions.rows());
  if (labelled.frames() < 30) return body;
  const RigidBody steady = find_steady_markers(labelled, reference);
  for (std::size_t m = 0; m < body.labels.size(); ++m) {
    const auto found = std::find(steady.labels.begin(), steady.labels.end(), body.labels[m]);
    body.deviations[static_cast<Eigen::Index>(m)] = found == steady.labels.end() ? 3.0 : 0.3;
  }
  return refine_body(labelled, body, reference, sampled_frames(labelled, 200));
}

Eigen::VectorXd gates(const RigidBody& layout) {
  Eigen::VectorXd gate(layout.positions.rows());
  for (Eigen::Index m = 0; m < gate.size(); ++m) {
    double nearest = 40.0;
    for (Eigen::Index k = 0; k < gate.size(); ++k)
      if (k != m) nearest = std::min(nearest, (layout.positions.row(k) - layout.positions.row(m)).norm());
    gate[m] = std::clamp(0.6 * nearest, 3.0, 12.0);
  }
  return gate;
}

std::optional<LayoutFit> match_layout(const RigidBody& layout, const Points& points, const Similarity& start,
                                      const std::vector<int>& known) {
  const Eigen::VectorXd gate = gates(layout);
  LayoutFit fit{start, known, 0};
  for (int round = 0; round < 4; ++round) {
    const Similarity back = fit.world_from_layout.inverse();
    const Points in_layout = transformed(back, points);
    const Points expected =
        fit.points.empty() ? layout.positions : displaced(layout, matched_rows(in_layout, fit.points));
    std::vector<int> next = assigned(expected, gate, in_layout);
    const auto pose = fit_body(layout, matched_rows(points, next));
    if (!pose) return {};
    const bool settled = next == fit.points;
    fit.points = std::move(next);
    fit.world_from_layout = pose->world_from_head;
    if (settled) break;
  }
  fit.matched = static_cast<int>(std::count_if(fit.points.begin(), fit.points.end(), [](int p) { return p >= 0; }));
  return fit;
}

std::optional<LayoutFit> align_layout(const RigidBody& layout, const Points& points) {
  const auto n = static_cast<int>(layout.positions.rows()), count = static_cast<int>(points.rows());
  const Eigen::VectorXd gate = gates(layout);
  const double steady = quantile(layout.deviations, 0.5), least = 0.2 * bounds(layout.positions).diagonal();
  Eigen::MatrixXd between(count, count);
  for (int i = 0; i < count; ++i) between.row(i) = (points.rowwise() - points.row(i)).rowwise().norm().transpose();
  Random random(20110815);
  Similarity best;
  double best_closeness = 0.0;
  int tried = 0;
  for (int attempt = 0; attempt < 4000 && tried < kTriples; ++attempt) {
    const int a = random.below(n), b = random.below(n), c = random.below(n);
    if (std::max({layout.deviations[a], layout.deviations[b], layout.deviations[c]}) > steady) continue;
    const auto apart = [&](int p, int q) { return (layout.positions.row(p) - layout.positions.row(q)).norm(); };
    const double ab = apart(a, b), ac = apart(a, c), bc = apart(b, c);
    if (std::min({ab, ac, bc}) < least || ab + ac + bc - 2.0 * std::max({ab, ac, bc}) < 0.2 * least) continue;
    ++tried;
    const double near = std::clamp(3.0 * steady, 1.0, 5.0);
    Points source(3, 3), target(3, 3);
    source << layout.positions.row(a), layout.positions.row(b), layout.positions.row(c);
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j < count; ++j) {
        if (std::abs(between(i, j) - ab) > near) continue;
        for (int k = 0; k < count; ++k) {
          if (std::abs(between(i, k) - ac) > near || std::abs(between(j, k) - bc) > near) continue;
          target << points.row(i), points.row(j), points.row(k);
          const Similarity pose = fit_similarity(source, target, Scaling::fixed);
          const double sum = closeness(layout, gate, points, pose);
          if (sum <= best_closeness) continue;
          best_closeness = sum;
          best = pose;
        }
      }
    }
    if (best_closeness > 0.85 * std::min(n, count)) break;
  }
  if (best_closeness == 0.0) return {};
  return match_layout(layout, points, best);
}

}  // namespace vultus::mocap
