#include "mocap/marker_model.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/statistics.h"

namespace vultus::mocap {

namespace {

constexpr int kTried = 14, kKept = 8;  // neighbours of a marker
constexpr std::size_t kLearned = 600;  // frames
constexpr double kRidge = 25.0;  // mm², against the motion of a marker at rest (its noise) being taken for a cause
constexpr double kKeptShare =
    0.7;  // of the frames, whose misses say what is usual: wrong labels are fewer than the rest

std::vector<int> thinned(const std::vector<int>& frames) {
  if (frames.size() <= kLearned) return frames;
  std::vector<int> result;
  for (std::size_t i = 0; i < kLearned; ++i) result.push_back(frames[i * frames.size() / kLearned]);
  return result;
}

Eigen::Vector3d median_place(const Take& take, const std::vector<int>& frames, int column) {
  Eigen::Vector3d place = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  std::array<std::vector<double>, 3> values;
  for (const int f : frames) {
    if (!take.has(f, column)) continue;
    const Eigen::Vector3d at = take.at(f, column);
    for (int c = 0; c < 3; ++c) values[static_cast<std::size_t>(c)].push_back(at[c]);
  }
  if (values[0].size() < 8) return place;
  for (int c = 0; c < 3; ++c) place[c] = quantile(std::move(values[static_cast<std::size_t>(c)]), 0.5);
  return place;
}

struct Weighted {
  double value, weight;
};

double weighted_median(std::array<Weighted, kKept>& values, std::size_t count) {
  std::sort(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count),
            [](const Weighted& a, const Weighted& b) { return a.value < b.value; });
  double total = 0.0, below = 0.0;
  for (std::size_t i = 0; i < count; ++i) total += values[i].weight;
  // Interpolated between the middles of the weights, so that the median moves smoothly when a neighbour does.
  for (std::size_t i = 0; i < count; ++i) {
    const double middle = below + 0.5 * values[i].weight;
    if (middle >= 0.5 * total) {
      if (i == 0) return values[0].value;
      const double before = below - 0.5 * values[i - 1].weight;
      const double t = (0.5 * total - before) / (middle - before);
      return (1.0 - t) * values[i - 1].value + t * values[i].value;
    }
    below += values[i].weight;
  }
  return values[count - 1].value;
}

}  // namespace

std::optional<MarkerModel::Link> MarkerModel::link(const Take& take, const std::vector<int>& frames, int marker,
                                                   int neighbour) const {
  std::vector<Eigen::Vector3d> x, y;
  for (const int f : frames) {
    if (!take.has(f, marker) || !take.has(f, neighbour)) continue;
    x.push_back(take.at(f, neighbour) - mean(neighbour));
    y.push_back(take.at(f, marker) - mean(marker));
  }
  if (x.size() < 12) return {};
  Link result{neighbour, Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero(), 0.0};
  std::vector<double> misses(x.size());
  const auto measure = [&] {
    for (std::size_t i = 0; i < x.size(); ++i) misses[i] = (y[i] - result.map * x[i] - result.offset).norm();
  };
  measure();
  for (int round = 0; round < 3; ++round) {
    const double limit = std::max(1.0, 6.0 * quantile(misses, kKeptShare));
    Eigen::Matrix3d xx = Eigen::Matrix3d::Zero(), yx = Eigen::Matrix3d::Zero();
    Eigen::Vector3d mx = Eigen::Vector3d::Zero(), my = Eigen::Vector3d::Zero();
    int n = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (misses[i] > limit) continue;
      mx += x[i];
      my += y[i];
      ++n;
    }
    mx /= n;
    my /= n;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (misses[i] > limit) continue;
      xx += (x[i] - mx) * (x[i] - mx).transpose();
      yx += (y[i] - my) * (x[i] - mx).transpose();
    }
    xx.diagonal().array() += kRidge;
    result.map = xx.ldlt().solve(yx.transpose()).transpose();
    result.offset = my - result.map * mx;
    measure();
  }
  const double scatter = quantile(std::move(misses), 0.7);
  result.weight = 1.0 / (scatter * scatter + 0.01);
  return result;
}

MarkerModel::MarkerModel(const Take& take, int markers, const std::vector<int>& frames)
    : means_(static_cast<std::size_t>(markers)),
      links_(static_cast<std::size_t>(markers)),
      scatter_(static_cast<std::size_t>(markers), std::numeric_limits<double>::infinity()) {
  const std::vector<int> learned = thinned(frames);
  tbb::parallel_for(0, markers, [&](int m) { means_[static_cast<std::size_t>(m)] = median_place(take, learned, m); });
  tbb::parallel_for(0, markers, [&](int m) {
    if (!mean(m).allFinite()) return;
    std::vector<int> others;
    for (int o = 0; o < markers; ++o)
      if (o != m && mean(o).allFinite()) others.push_back(o);
    const auto distance = [&](int o) { return (mean(o) - mean(m)).squaredNorm(); };
    std::stable_sort(others.begin(), others.end(), [&](int a, int b) { return distance(a) < distance(b); });
    if (others.size() > kTried) others.resize(kTried);
    std::vector<Link>& links = links_[static_cast<std::size_t>(m)];
    for (const int o : others)
      if (const auto found = link(take, learned, m, o)) links.push_back(*found);
    std::stable_sort(links.begin(), links.end(), [](const Link& a, const Link& b) { return a.weight > b.weight; });
    if (links.size() > kKept) links.resize(kKept);
  });
  tbb::parallel_for(0, markers, [&](int m) {
    std::vector<double> misses;
    for (const int f : learned) {
      if (!take.has(f, m)) continue;
      if (const auto place = predicted(take, f, m)) misses.push_back((*place - take.at(f, m)).norm());
    }
    if (misses.size() >= 8) scatter_[static_cast<std::size_t>(m)] = std::max(0.05, quantile(std::move(misses), 0.7));
  });
}

std::optional<Eigen::Vector3d> MarkerModel::predicted(const Take& take, int frame, int m) const {
  std::array<std::array<Weighted, kKept>, 3> values;
  std::size_t count = 0;
  for (const Link& link : links_[static_cast<std::size_t>(m)]) {
    if (!take.has(frame, link.neighbour)) continue;
    const Eigen::Vector3d offset = link.map * (take.at(frame, link.neighbour) - mean(link.neighbour)) + link.offset;
    for (std::size_t c = 0; c < 3; ++c) values[c][count] = {offset[static_cast<Eigen::Index>(c)], link.weight};
    ++count;
  }
  if (count < 2) return {};
  Eigen::Vector3d place = mean(m);
  for (std::size_t c = 0; c < 3; ++c) place[static_cast<Eigen::Index>(c)] += weighted_median(values[c], count);
  return place;
}

}  // namespace vultus::mocap
