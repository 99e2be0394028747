#include "apps/bench_mocap/gap_cells.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "apps/bench_mocap/interpolation.h"
#include "core/random.h"
#include "mocap/gaps.h"

namespace vultus::apps::bench_mocap {

namespace {

constexpr int kKnots = 30;  // samples on each side that interpolation sees; more change nothing

using Yardsticks = std::array<double, 3>;  // mm, summed over samples

struct Cut {
  std::vector<int> markers;
  int first = 0, last = 0;
};

bool seen(const mocap::Take& take, int marker, int first, int last) {
  if (first < 0 || last >= take.frames()) return false;
  for (int f = first; f <= last; ++f) {
    if (!take.has(f, marker)) return false;
  }
  return true;
}

/// The marker and the `count` - 1 nearest to it on average over the take.
std::vector<int> neighbourhood(const mocap::Take& take, int marker, int count) {
  std::vector<double> distance(take.labels.size(), 0.0);
  for (int m = 0; m < take.markers(); ++m) {
    int together = 0;
    for (int f = 0; f < take.frames(); f += 10) {
      if (!take.has(f, m) || !take.has(f, marker)) continue;
      distance[static_cast<std::size_t>(m)] += (take.at(f, m) - take.at(f, marker)).norm();
      ++together;
    }
    distance[static_cast<std::size_t>(m)] /= std::max(together, 1);
    if (together == 0) distance[static_cast<std::size_t>(m)] = 1e9;
  }
  std::vector<int> order(take.labels.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return distance[static_cast<std::size_t>(a)] < distance[static_cast<std::size_t>(b)];
  });
  order.resize(std::min<std::size_t>(order.size(), static_cast<std::size_t>(count)));
  return order;
}

/// As many cuts as chance places without two within `length` frames of each other, at most `most`.
std::vector<Cut> batch(const mocap::Take& take, int length, int count, int most, Random& random) {
  std::vector<Cut> cuts;
  for (int attempt = 0; attempt < 400 && static_cast<int>(cuts.size()) < most; ++attempt) {
    const int first = kKnots + random.below(std::max(1, take.frames() - length - 2 * kKnots));
    Cut cut{neighbourhood(take, random.below(take.markers()), count), first, first + length - 1};
    const auto near = [&](const Cut& other) {
      return cut.first <= other.last + length && other.first <= cut.last + length;
    };
    const auto complete = [&](int m) { return seen(take, m, first - kKnots, cut.last + kKnots); };
    if (std::any_of(cuts.begin(), cuts.end(), near)) continue;
    if (std::all_of(cut.markers.begin(), cut.markers.end(), complete)) cuts.push_back(std::move(cut));
  }
  return cuts;
}

mocap::Take without(const mocap::Take& steady, const std::vector<Cut>& cuts) {
  mocap::Take take = steady;
  for (const Cut& cut : cuts) {
    for (const int m : cut.markers) {
      for (int f = cut.first; f <= cut.last; ++f) take.drop(f, m);
    }
  }
  return take;
}

void compare(const mocap::Take& truth, const mocap::Filled& filled, const Cut& cut, GapCell& cell,
             Yardsticks& yardsticks) {
  for (const int m : cut.markers) {
    Points before(kKnots, 3), after(kKnots, 3);
    for (int i = 0; i < kKnots; ++i) {
      before.row(i) = truth.at(cut.first - kKnots + i, m).transpose();
      after.row(i) = truth.at(cut.last + 1 + i, m).transpose();
    }
    const auto simple = interpolations(before, after, cut.last - cut.first + 1);
    for (int f = cut.first; f <= cut.last; ++f) {
      if (!filled.take.has(f, m)) {
        ++cell.holes;
        continue;
      }
      const Eigen::Vector3d place = truth.at(f, m);
      const double error = (filled.take.at(f, m) - place).norm();
      ++cell.samples;
      cell.errors += error;
      cell.covered += error <= filled.expected_errors[truth.index(f, m)];
      for (std::size_t k = 0; k < simple.size(); ++k) {
        yardsticks[k] += (simple[k].row(f - cut.first).transpose() - place).norm();
      }
    }
  }
  ++cell.trials;
}

}  // namespace

std::string gap_key(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", seconds);
  return text;
}

GapCell& GapCell::operator+=(const GapCell& other) {
  trials += other.trials;
  samples += other.samples;
  errors += other.errors;
  covered += other.covered;
  holes += other.holes;
  interpolation += other.interpolation;
  return *this;
}

GapCell measure_cell(const std::vector<mocap::Take>& steady, double seconds, int count, int trials, std::uint64_t seed,
                     Progress& progress) {
  GapCell cell;
  cell.seconds = seconds;
  cell.count = count;
  Yardsticks yardsticks{};
  for (std::size_t t = 0; t < steady.size(); ++t) {
    const int wanted = static_cast<int>(trials * (t + 1) / steady.size());
    const int length = std::max(1, static_cast<int>(std::lround(seconds * steady[t].rate_hz)));
    Random random(seed + t, static_cast<std::uint64_t>(100 * length + count));
    while (cell.trials < wanted) {
      progress.check();
      // Cuts are made together only where they take hardly any of what fillers learn from.
      const int most = std::clamp(steady[t].frames() / (10 * length), 1, wanted - cell.trials);
      const std::vector<Cut> cuts = batch(steady[t], length, count, most, random);
      if (cuts.empty()) break;
      const mocap::Filled filled = mocap::fill_gaps(without(steady[t], cuts), {.seed = seed});
      for (const Cut& cut : cuts) compare(steady[t], filled, cut, cell, yardsticks);
    }
  }
  cell.interpolation = *std::min_element(yardsticks.begin(), yardsticks.end());
  return cell;
}

}  // namespace vultus::apps::bench_mocap
