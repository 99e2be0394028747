#include "mocap/steady_markers.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "core/random.h"
#include "core/statistics.h"

namespace vultus::mocap {

namespace {

constexpr double kNoise = 0.1;  // mm; steadier than this makes no difference to the choice

struct Triple {
  int a, b, c;
};

int seen_markers(const Take& take, int frame) {
  const std::uint8_t* row = take.present.data() + take.index(frame, 0);
  return static_cast<int>(std::count(row, row + take.markers(), std::uint8_t{1}));
}

/// Markers seen in at least half of the frames and in the reference frame.
std::vector<int> usable_markers(const Take& take, int reference, const std::vector<int>& frames) {
  std::vector<int> usable;
  for (int m = 0; m < take.markers(); ++m) {
    const auto seen = std::count_if(frames.begin(), frames.end(), [&](int f) { return take.has(f, m); });
    if (take.has(reference, m) && 2 * static_cast<std::size_t>(seen) >= frames.size()) usable.push_back(m);
  }
  return usable;
}

/// Right-handed frame on three points; columns are its axes, `origin` their mean.
Eigen::Isometry3d frame_on(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  Eigen::Isometry3d frame;
  const Eigen::Vector3d x = (b - a).normalized(), z = x.cross(c - a).normalized();
  frame.linear() << x, z.cross(x), z;
  frame.translation() = (a + b + c) / 3.0;
  return frame;
}

double altitude(const Points& p, const Triple& t) {
  const Eigen::RowVector3d ab = p.row(t.b) - p.row(t.a), ac = p.row(t.c) - p.row(t.a), bc = p.row(t.c) - p.row(t.b);
  return ab.cross(ac).norm() / std::max({ab.norm(), ac.norm(), bc.norm()});
}

/// Triples that span the face: the seeded choice among those whose least altitude is above a fifth of its extent.
std::vector<Triple> spread_triples(const Points& reference, int count) {
  const double least = 0.2 * bounds(reference(rows_together(reference), Eigen::all)).diagonal();
  Random random(20110815);
  const auto n = static_cast<int>(reference.rows());
  std::vector<Triple> triples;
  for (int attempt = 0; attempt < 200 * count && static_cast<int>(triples.size()) < count; ++attempt) {
    const Triple t{random.below(n), random.below(n), random.below(n)};
    if (t.a == t.b || t.b == t.c || t.a == t.c || altitude(reference, t) < least) continue;
    triples.push_back(t);
  }
  return triples;
}

/// How far each marker strays (80 % quantile over frames) when the triple is taken as the head.
std::vector<double> strays(const std::vector<Points>& frames, const Points& reference, const Triple& t) {
  const auto n = static_cast<std::size_t>(reference.rows());
  std::vector<std::vector<double>> distances(n);
  const Eigen::Isometry3d rest = frame_on(reference.row(t.a), reference.row(t.b), reference.row(t.c));
  for (const Points& p : frames) {
    if (!p.row(t.a).allFinite() || !p.row(t.b).allFinite() || !p.row(t.c).allFinite()) continue;
    const Eigen::Isometry3d head = rest * frame_on(p.row(t.a), p.row(t.b), p.row(t.c)).inverse();
    for (std::size_t m = 0; m < n; ++m) {
      const auto row = static_cast<Eigen::Index>(m);
      if (!p.row(row).allFinite()) continue;
      distances[m].push_back((head * Eigen::Vector3d(p.row(row)) - Eigen::Vector3d(reference.row(row))).norm());
    }
  }
  std::vector<double> result;
  for (auto& d : distances) result.push_back(d.empty() ? 1e3 : quantile(std::move(d), 0.8));
  return result;
}

/// Mean logarithm over the steadiest half: low when many markers are at rest together.
double unrest(std::vector<double> deviations) {
  std::sort(deviations.begin(), deviations.end());
  const std::size_t half = (deviations.size() + 1) / 2;
  double sum = 0.0;
  for (std::size_t i = 0; i < half; ++i) sum += std::log(deviations[i] * deviations[i] + kNoise * kNoise);
  return sum / static_cast<double>(half);
}

RigidBody body_of(const Take& take, const std::vector<int>& markers, int reference,
                  const std::vector<double>& strays_mm) {
  RigidBody body;
  const auto n = static_cast<Eigen::Index>(markers.size());
  body.positions.resize(n, 3);
  body.deviations.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    body.labels.push_back(take.labels[static_cast<std::size_t>(markers[k])]);
    body.positions.row(i) = take.at(reference, markers[k]).transpose();
    body.deviations(i) = std::max(kNoise, strays_mm[k]);
  }
  return body;
}

/// Deviations no smaller than the median of the steadiest quarter: a few markers must not declare themselves the head.
void level(RigidBody& body) {
  std::vector<double> sorted(body.deviations.data(), body.deviations.data() + body.deviations.size());
  std::sort(sorted.begin(), sorted.end());
  const double floor = std::max(kNoise / 2.0, sorted[sorted.size() / 8]);
  body.deviations = (body.deviations.array().square() + floor * floor).sqrt();
}

RigidBody kept(const RigidBody& body, double tolerance) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(body.deviations.size()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return body.deviations(a) < body.deviations(b); });
  const double limit = tolerance * body.deviations(order[order.size() / 8]);
  std::vector<Eigen::Index> rows;
  for (const Eigen::Index row : order) {
    if (rows.size() < 6 || body.deviations(row) <= limit) rows.push_back(row);
  }
  std::sort(rows.begin(), rows.end());
  RigidBody result;
  result.positions = body.positions(rows, Eigen::all);
  result.deviations = body.deviations(rows);
  for (const Eigen::Index row : rows) result.labels.push_back(body.labels[static_cast<std::size_t>(row)]);
  return result;
}

}  // namespace

std::vector<int> sampled_frames(const Take& take, int at_most) {
  int most = 0;
  for (int f = 0; f < take.frames(); ++f) most = std::max(most, seen_markers(take, f));
  std::vector<int> complete;
  for (int f = 0; f < take.frames(); ++f) {
    if (most > 0 && 2 * seen_markers(take, f) >= most) complete.push_back(f);
  }
  if (static_cast<int>(complete.size()) <= at_most) return complete;
  std::vector<int> sampled;
  for (int i = 0; i < at_most; ++i) {
    sampled.push_back(complete[complete.size() * static_cast<std::size_t>(i) / static_cast<std::size_t>(at_most)]);
  }
  return sampled;
}

int central_frame(const Take& take, const std::vector<int>& columns) {
  const std::vector<int> frames = sampled_frames(take, 60);
  if (frames.empty()) throw InputError("take '" + take.name + "' holds no samples");
  std::vector<Points> points;
  Eigen::Index most = 0;
  for (const int f : frames) {
    points.push_back(observed_rows(take, f, columns));
    most = std::max(most, points.back().rowwise().sum().array().isFinite().count());
  }
  std::vector<double> unlike(frames.size(), std::numeric_limits<double>::infinity());
  tbb::parallel_for(std::size_t{0}, frames.size(), [&](std::size_t i) {
    if (10 * points[i].rowwise().sum().array().isFinite().count() < 9 * most) return;
    RigidBody body{take.labels, points[i], Eigen::VectorXd::Constant(points[i].rows(), 1.0)};
    std::vector<double> distances;
    for (std::size_t j = 0; j < frames.size(); ++j) {
      const auto pose = fit_body(body, points[j]);
      if (j != i && pose) distances.push_back(pose->rms);
    }
    if (!distances.empty()) unlike[i] = median(distances);
  });
  return frames[static_cast<std::size_t>(std::min_element(unlike.begin(), unlike.end()) - unlike.begin())];
}

RigidBody find_steady_markers(const Take& take, int reference_frame, double tolerance) {
  const std::vector<int> frames = sampled_frames(take, 120);
  const std::vector<int> markers = usable_markers(take, reference_frame, frames);
  if (markers.size() < 6) {
    throw InputError("take '" + take.name + "': fewer than 6 markers are seen in half of the frames and in frame " +
                     std::to_string(reference_frame) + "; the head cannot be found without a jig");
  }
  std::vector<Points> observed;
  for (const int f : frames) observed.push_back(observed_rows(take, f, markers));
  const Points reference = observed_rows(take, reference_frame, markers);
  const std::vector<Triple> triples = spread_triples(reference, 800);
  if (triples.empty()) throw InputError("take '" + take.name + "': the markers lie on a line");
  std::vector<double> scores(triples.size());
  tbb::parallel_for(std::size_t{0}, triples.size(),
                    [&](std::size_t i) { scores[i] = unrest(strays(observed, reference, triples[i])); });
  const auto best = static_cast<std::size_t>(std::min_element(scores.begin(), scores.end()) - scores.begin());
  RigidBody body = body_of(take, markers, reference_frame, strays(observed, reference, triples[best]));
  for (int round = 0; round < 3; ++round) {
    level(body);
    body = refine_body(take, body, reference_frame, frames);
  }
  level(body);
  body = kept(body, tolerance);
  body = refine_body(take, body, reference_frame, frames);
  level(body);
  return body;
}

}  // namespace vultus::mocap
