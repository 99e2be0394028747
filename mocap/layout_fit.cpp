#include "mocap/layout_fit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/error.h"
#include "core/random.h"
#include "core/statistics.h"
#include "mocap/assignment.h"
#include "mocap/steady_markers.h"
#include "mocap/tracklets.h"

namespace vultus::mocap {

namespace {

constexpr std::size_t kTriples = 40;
constexpr int kLeastTriples = 6;  // a rival pose needs its chance, too: some of its markers are missing
constexpr int kNeighbours = 6;
constexpr double kMovingDeviation = 3.0;  // mm; of markers that are not among the steadiest, until it is measured
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// How near the markers are to points under a pose, 1 for each that is on one: a hash of cells twice as wide as the
/// widest gate holds the points, so that only those around a marker are looked at.
class Closeness {
 public:
  Closeness(const RigidBody& layout, const Eigen::VectorXd& gate, const Points& points)
      : layout_(layout), gate_(gate), points_(points), cell_(2.0 * gate.maxCoeff()) {
    for (int i = 0; i < points.rows(); ++i) cells_[key(cell_of(points.row(i)))].push_back(i);
  }

  double operator()(const Similarity& pose) const {
    double sum = 0.0;
    for (Eigen::Index m = 0; m < layout_.positions.rows(); ++m) {
      const double gate2 = gate_[m] * gate_[m];
      sum += 1.0 - std::min(1.0, nearest2(pose * Eigen::Vector3d(layout_.positions.row(m))) / gate2);
    }
    return sum;
  }

 private:
  using Cell = Eigen::Array<std::int64_t, 3, 1>;
  Cell cell_of(const Eigen::Vector3d& p) const { return (p.array() / cell_).floor().cast<std::int64_t>(); }
  /// Cells that share a key only cost time.
  static std::uint64_t key(const Cell& c) {
    return static_cast<std::uint64_t>((c[0] * 73856093) ^ (c[1] * 19349663) ^ (c[2] * 83492791)) & 4095U;
  }
  double nearest2(const Eigen::Vector3d& p) const {
    double least = std::numeric_limits<double>::infinity();
    const Cell low = cell_of(p.array() - 0.5 * cell_);
    // Whatever is within half a cell, the widest gate, is in these eight.
    for (int corner = 0; corner < 8; ++corner)
      for (const int i : cells_[key(low + Cell(corner & 1, (corner >> 1) & 1, corner >> 2))])
        least = std::min(least, (points_.row(i).transpose() - p).squaredNorm());
    return least;
  }

  const RigidBody& layout_;
  const Eigen::VectorXd& gate_;
  const Points& points_;
  double cell_;
  std::vector<std::vector<int>> cells_ = std::vector<std::vector<int>>(4096);
};

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

/// Markers and points that are within gates of each other, directly or through others.
struct Cluster {
  std::vector<Eigen::Index> markers;
  std::vector<int> points;
};

/// Gates are narrower than the distances between markers, so that clusters are small.
std::vector<Cluster> clusters(const std::vector<std::vector<int>>& near, Eigen::Index points) {
  std::vector<std::vector<Eigen::Index>> markers_of(static_cast<std::size_t>(points));
  for (std::size_t m = 0; m < near.size(); ++m)
    for (const int p : near[m]) markers_of[static_cast<std::size_t>(p)].push_back(static_cast<Eigen::Index>(m));
  std::vector<std::uint8_t> marker_taken(near.size(), 0), point_taken(markers_of.size(), 0);
  std::vector<Cluster> found;
  for (std::size_t seed = 0; seed < near.size(); ++seed) {
    if (marker_taken[seed]++ || near[seed].empty()) continue;
    Cluster cluster{{static_cast<Eigen::Index>(seed)}, {}};
    for (std::size_t i = 0; i < cluster.markers.size(); ++i) {
      for (const int p : near[static_cast<std::size_t>(cluster.markers[i])]) {
        if (point_taken[static_cast<std::size_t>(p)]++) continue;
        cluster.points.push_back(p);
        for (const Eigen::Index m : markers_of[static_cast<std::size_t>(p)])
          if (!marker_taken[static_cast<std::size_t>(m)]++) cluster.markers.push_back(m);
      }
    }
    found.push_back(std::move(cluster));
  }
  return found;
}

/// One-to-one; each marker may stay without a point at the price of a point on its gate, so that each cluster can be
/// settled by itself.
std::vector<int> assigned(const Points& expected, const Eigen::VectorXd& gate, const Points& points) {
  const auto cost = [&](Eigen::Index m, int p) {
    return (points.row(p) - expected.row(m)).squaredNorm() / (gate[m] * gate[m]);
  };
  std::vector<std::vector<int>> near(static_cast<std::size_t>(expected.rows()));
  for (Eigen::Index m = 0; m < expected.rows(); ++m)
    for (int p = 0; p < points.rows(); ++p)
      if (cost(m, p) < 1.0) near[static_cast<std::size_t>(m)].push_back(p);
  std::vector<int> match(near.size(), -1);
  for (const Cluster& cluster : clusters(near, points.rows())) {
    const auto rows = static_cast<Eigen::Index>(cluster.markers.size());
    const auto count = static_cast<Eigen::Index>(cluster.points.size());
    Eigen::MatrixXd costs = Eigen::MatrixXd::Ones(rows, count + rows);
    for (Eigen::Index i = 0; i < rows; ++i)
      for (Eigen::Index k = 0; k < count; ++k)
        costs(i, k) = std::min(
            1.0, cost(cluster.markers[static_cast<std::size_t>(i)], cluster.points[static_cast<std::size_t>(k)]));
    const std::vector<int> column = least_cost_assignment(costs);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const int k = column[static_cast<std::size_t>(i)];
      if (k < count && costs(i, k) < 1.0)
        match[static_cast<std::size_t>(cluster.markers[static_cast<std::size_t>(i)])] =
            cluster.points[static_cast<std::size_t>(k)];
    }
  }
  return match;
}

double cost_of(const RigidBody& layout, const Eigen::VectorXd& gate, const Points& points, const LayoutFit& fit) {
  double sum = 0.0;
  for (Eigen::Index m = 0; m < layout.positions.rows(); ++m) {
    const int p = fit.points[static_cast<std::size_t>(m)];
    const Eigen::Vector3d at = fit.world_from_layout * Eigen::Vector3d(layout.positions.row(m));
    sum += p < 0 ? 1.0 : std::min(1.0, (points.row(p).transpose() - at).squaredNorm() / (gate[m] * gate[m]));
  }
  return sum;
}

struct Candidate {
  Similarity pose;
  double closeness;
};

/// The best of each pose, clearest first.
class Candidates {
 public:
  Candidates(const RigidBody& layout, const Eigen::VectorXd& gate)
      : layout_(layout), apart_(1.5 * quantile(gate, 0.5)) {}

  double least() const { return found_.size() < kPoses ? 0.0 : found_.back().closeness; }
  const std::vector<Candidate>& found() const { return found_; }

  void add(const Candidate& candidate) {
    if (candidate.closeness <= least()) return;
    for (const Candidate& other : found_)
      if (same(candidate.pose, other.pose) && other.closeness >= candidate.closeness) return;
    std::erase_if(found_, [&](const Candidate& other) { return same(candidate.pose, other.pose); });
    const auto place = std::find_if(found_.begin(), found_.end(),
                                    [&](const Candidate& other) { return other.closeness < candidate.closeness; });
    found_.insert(place, candidate);
    if (found_.size() > kPoses) found_.pop_back();
  }

  /// Whether the poses put most markers at about the same places.
  bool same(const Similarity& a, const Similarity& b) const {
    const Points apart = transformed(a, layout_.positions) - transformed(b, layout_.positions);
    return apart.rowwise().squaredNorm().mean() < apart_ * apart_;
  }

 private:
  static constexpr std::size_t kPoses = 6;
  const RigidBody& layout_;
  double apart_;  // mm RMS
  std::vector<Candidate> found_;
};

struct Triple {
  Eigen::Index a, b, c;
  double ab, ac, bc;
};

/// Steady markers far apart and not in a line, in the order in which a seeded choice finds them.
std::vector<Triple> spread_triples(const RigidBody& layout) {
  const auto n = static_cast<int>(layout.positions.rows());
  const double steady = quantile(layout.deviations, 0.5), least = 0.2 * bounds(layout.positions).diagonal();
  Random random(20110815);
  std::vector<Triple> triples;
  for (int attempt = 0; attempt < 4000 && triples.size() < kTriples; ++attempt) {
    const int a = random.below(n), b = random.below(n), c = random.below(n);
    if (std::max({layout.deviations[a], layout.deviations[b], layout.deviations[c]}) > steady) continue;
    const auto apart = [&](int p, int q) { return (layout.positions.row(p) - layout.positions.row(q)).norm(); };
    const Triple t{a, b, c, apart(a, b), apart(a, c), apart(b, c)};
    const double longest = std::max({t.ab, t.ac, t.bc});
    if (std::min({t.ab, t.ac, t.bc}) < least || t.ab + t.ac + t.bc - 2.0 * longest < 0.2 * least) continue;
    triples.push_back(t);
  }
  return triples;
}

/// Tries every triple of points with the distances of `t`.
void try_triple(const RigidBody& layout, const Triple& t, const Points& points, const Eigen::MatrixXd& between,
                const Closeness& closeness, Candidates& candidates) {
  const double near = std::clamp(3.0 * quantile(layout.deviations, 0.5), 1.0, 5.0);
  const auto count = points.rows();
  Points source(3, 3), target(3, 3);
  source << layout.positions.row(t.a), layout.positions.row(t.b), layout.positions.row(t.c);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) {
      if (std::abs(between(i, j) - t.ab) > near) continue;
      for (Eigen::Index k = 0; k < count; ++k) {
        if (std::abs(between(k, i) - t.ac) > near || std::abs(between(k, j) - t.bc) > near) continue;
        target << points.row(i), points.row(j), points.row(k);
        const Similarity pose = fit_similarity(source, target, Scaling::fixed);
        candidates.add({pose, closeness(pose)});
      }
    }
  }
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
  std::erase_if(columns, [&](int c) { return !labelled.has(reference, c); });
  const Points seen = observed_rows(labelled, reference, columns);
  const std::vector<Eigen::Index> rows = rows_together(seen);
  for (const Eigen::Index row : rows)
    body.labels.push_back(labelled.labels[static_cast<std::size_t>(columns[static_cast<std::size_t>(row)])]);
  body.positions = seen(rows, Eigen::all);
  body.deviations = Eigen::VectorXd::Ones(body.positions.rows());
  if (labelled.frames() < 30) return body;
  const RigidBody steady = find_steady_markers(labelled, reference);
  for (std::size_t m = 0; m < body.labels.size(); ++m) {
    const auto found = std::find(steady.labels.begin(), steady.labels.end(), body.labels[m]);
    body.deviations[static_cast<Eigen::Index>(m)] = found == steady.labels.end() ? kMovingDeviation : start_deviation;
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
  LayoutFit fit;
  fit.world_from_layout = start;
  fit.points = known;
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
  fit.cost = cost_of(layout, gate, points, fit);
  return fit;
}

std::optional<LayoutFit> align_layout(const RigidBody& layout, const Points& points) {
  const auto n = static_cast<int>(layout.positions.rows()), count = static_cast<int>(points.rows());
  const Eigen::VectorXd gate = gates(layout);
  Eigen::MatrixXd between(count, count);
  for (int i = 0; i < count; ++i) between.row(i) = (points.rowwise() - points.row(i)).rowwise().norm().transpose();
  const Closeness closeness(layout, gate, points);
  Candidates candidates(layout, gate);
  int tried = 0;
  for (const Triple& triple : spread_triples(layout)) {
    try_triple(layout, triple, points, between, closeness, candidates);
    const bool clear = !candidates.found().empty() && candidates.found().front().closeness > 0.85 * std::min(n, count);
    if (++tried >= kLeastTriples && clear) break;
  }
  std::vector<LayoutFit> fits;
  for (const Candidate& candidate : candidates.found())
    if (auto fit = match_layout(layout, points, candidate.pose)) fits.push_back(std::move(*fit));
  if (fits.empty()) return {};
  std::stable_sort(fits.begin(), fits.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; });
  // Refinement may have brought two poses together.
  for (std::size_t i = 1; i < fits.size(); ++i) {
    if (candidates.same(fits[0].world_from_layout, fits[i].world_from_layout)) continue;
    fits[0].rival_cost = fits[i].cost;
    break;
  }
  return fits[0];
}

}  // namespace vultus::mocap
