#include "mocap/gap_errors.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/statistics.h"
#include "mocap/gap_trials.h"

namespace vultus::mocap {

namespace {

constexpr double kCovered = 0.7;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// What came of a trial, one entry a frame of its gap; empty when the method gave up.
struct Outcome {
  std::vector<double> errors, scales;
};

/// Four classes from the gap's end (0) to its middle, or to the far end of a gap at the take's edge.
int place_of(int frame, const Gap& gap, bool open_left, bool open_right, int places) {
  const double n = gap.frames();
  const double from_left = open_left ? kInfinite : frame - gap.first + 1;
  const double from_right = open_right ? kInfinite : gap.last - frame + 1;
  const double depth = std::min(from_left, from_right) / (open_left || open_right ? n : 0.5 * (n + 1.0));
  return std::clamp(static_cast<int>(depth * places - 1e-9), 0, places - 1);
}

bool open_side(const Take& take, const Gap& gap) {
  return gap.first == 0 || gap.last + 1 >= take.frames() || !take.has(gap.first - 1, gap.marker) ||
         !take.has(gap.last + 1, gap.marker);
}

/// 1, growth, growth², …, longest, as far as they are next to the length of a gap of the kind.
std::vector<int> lengths_for(const Take& take, const std::vector<Gap>& gaps, bool edge, int longest, int growth) {
  std::vector<int> grid;
  for (int length = 1; length < longest; length *= growth) grid.push_back(length);
  grid.push_back(std::max(1, longest));
  std::vector<bool> wanted(grid.size(), false);
  for (const Gap& gap : gaps) {
    if (open_side(take, gap) != edge) continue;
    const auto above = std::lower_bound(grid.begin(), grid.end(), gap.frames()) - grid.begin();
    const auto last = static_cast<std::ptrdiff_t>(grid.size()) - 1;
    wanted[static_cast<std::size_t>(std::min(above, last))] = true;
    wanted[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(above - 1, 0, last))] = true;
  }
  std::vector<int> lengths;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (wanted[i]) lengths.push_back(grid[i]);
  }
  return lengths;
}

/// None, some or most of the neighbours missing too.
constexpr int kCrowdClasses = 3;
int class_of(int crowd) { return crowd == 0 ? 0 : (crowd <= kTrialCrowd / 2 ? 1 : 2); }

/// Quantile of ratios, drawn towards 1 by some samples' worth of belief that all are alike.
double factor(const std::vector<double>& relative) {
  constexpr double prior = 50.0;
  const auto n = static_cast<double>(relative.size());
  return n > 0.0 ? (n * quantile(relative, kCovered) + prior) / (n + prior) : 1.0;
}

std::vector<Outcome> outcomes_of(const Take& take, const std::vector<GapTrial>& trials,
                                 const GapErrors::Method& method) {
  std::vector<Outcome> outcomes(trials.size());
  tbb::parallel_for(std::size_t{0}, trials.size(), [&](std::size_t i) {
    const Gap& gap = trials[i].gap;
    const auto guess = method(TakeView{take, trials[i].hidden}, gap);
    if (!guess) return;
    for (int f = gap.first; f <= gap.last; ++f) {
      const Eigen::Vector3d place = guess->places.row(f - gap.first).transpose();
      outcomes[i].errors.push_back((place - take.at(f, gap.marker)).norm());
      outcomes[i].scales.push_back(guess->scale(f - gap.first));
    }
  });
  return outcomes;
}

}  // namespace

struct GapErrors::Trials {
  std::vector<GapTrial> cuts;
  std::vector<Outcome> outcomes;
};

GapErrors::GapErrors(const Take& take, const RigidGroups& groups, const std::vector<Gap>& gaps, const Method& method,
                     int longest, int trials, int growth, std::uint64_t seed)
    : groups_(groups), marker_factor_(take.labels.size(), 1.0), crowd_factor_(kCrowdClasses, 1.0) {
  std::vector<std::vector<double>> by_marker(take.labels.size()), by_crowd(kCrowdClasses);
  for (const bool edge : {false, true}) {
    for (const int length : lengths_for(take, gaps, edge, longest, growth)) {
      Trials tried{cut_trials(take, groups, length, edge, trials, seed), {}};
      tried.outcomes = outcomes_of(take, tried.cuts, method);
      learn(tried, length, edge, by_marker, by_crowd);
    }
  }
  for (std::size_t k = 0; k < by_crowd.size(); ++k) crowd_factor_[k] = factor(by_crowd[k]);
  for (std::size_t m = 0; m < by_marker.size(); ++m) marker_factor_[m] = factor(by_marker[m]);
}

void GapErrors::learn(const Trials& trials, int length, bool edge, std::vector<std::vector<double>>& by_marker,
                      std::vector<std::vector<double>>& by_crowd) {
  std::array<std::vector<double>, kPlaces> pooled;
  std::vector<double> errors;
  const auto each = [&](const auto& act) {
    for (std::size_t i = 0; i < trials.cuts.size(); ++i) {
      const Outcome& outcome = trials.outcomes[i];
      const Gap& gap = trials.cuts[i].gap;
      for (std::size_t k = 0; k < outcome.errors.size(); ++k) {
        const int place = place_of(gap.first + static_cast<int>(k), gap, edge, false, kPlaces);
        act(trials.cuts[i], static_cast<std::size_t>(place), outcome.errors[k], outcome.scales[k]);
      }
    }
  };
  each([&](const GapTrial&, std::size_t place, double error, double scale) {
    pooled[place].push_back(error / scale);
    errors.push_back(error);
  });
  if (errors.empty()) return;
  Row row{length, {}, quantile(errors, kCovered)};
  double last = 0.0;
  for (int place = 0; place < kPlaces; ++place) {
    // Short gaps have no sample in some places; they take the figure of the place before.
    const auto& here = pooled[static_cast<std::size_t>(place)];
    last = row.error[place] = here.empty() ? last : quantile(here, kCovered);
  }
  for (int place = kPlaces - 2; place >= 0; --place) {
    if (row.error[place] == 0.0) row.error[place] = row.error[place + 1];
  }
  (edge ? edge_ : inside_).push_back(row);
  each([&](const GapTrial& cut, std::size_t place, double error, double scale) {
    const double relative = error / (scale * std::max(row.error[place], 1e-9));
    by_crowd[static_cast<std::size_t>(class_of(cut.crowd))].push_back(relative);
    if (!edge) by_marker[static_cast<std::size_t>(cut.gap.marker)].push_back(relative);
  });
}

double GapErrors::interpolated(const std::vector<Row>& rows, int length,
                               const std::function<double(const Row&)>& value) {
  if (rows.empty()) return kInfinite;
  const auto above = std::find_if(rows.begin(), rows.end(), [&](const Row& row) { return row.length >= length; });
  if (above == rows.end()) return value(rows.back()) * length / rows.back().length;
  if (above == rows.begin()) return value(*above);
  const auto below = above - 1;
  const double t = std::log(static_cast<double>(length) / below->length) /
                   std::log(static_cast<double>(above->length) / below->length);
  return (1.0 - t) * value(*below) + t * value(*above);
}

double GapErrors::expected(const Take& take, const Gap& gap, int frame, double scale) const {
  const bool open_left = gap.first == 0 || !take.has(gap.first - 1, gap.marker);
  const bool open_right = gap.last + 1 >= take.frames() || !take.has(gap.last + 1, gap.marker);
  const int place = place_of(frame, gap, open_left, open_right, kPlaces);
  const double error = interpolated(open_left || open_right ? edge_ : inside_, gap.frames(),
                                    [&](const Row& row) { return row.error[place]; });
  return marker_factor_[static_cast<std::size_t>(gap.marker)] *
         crowd_factor_[static_cast<std::size_t>(crowd_class(take, gap))] * scale * error;
}

int GapErrors::crowd_class(const Take& take, const Gap& gap) const {
  const auto& neighbours = groups_.of(gap.marker);
  int crowd = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(neighbours.size(), kTrialCrowd); ++i) {
    int missing = 0;
    for (int f = gap.first; f <= gap.last; ++f) missing += !take.has(f, neighbours[i].marker);
    crowd += 2 * missing > gap.frames();
  }
  return class_of(crowd);
}

double GapErrors::typical(int length) const {
  return interpolated(inside_, length, [](const Row& row) { return row.typical; });
}

}  // namespace vultus::mocap
