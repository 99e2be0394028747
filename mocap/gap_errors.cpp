#include "mocap/gap_errors.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "mocap/gap_trials.h"
#include "mocap/statistics.h"

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

std::vector<int> lengths_up_to(int longest, int growth) {
  std::vector<int> lengths;
  for (int length = 1; length < longest; length *= growth) lengths.push_back(length);
  lengths.push_back(std::max(1, longest));
  return lengths;
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

GapErrors::GapErrors(const Take& take, const RigidGroups& groups, const Method& method, int longest, int trials,
                     int growth, std::uint64_t seed)
    : marker_factor_(take.labels.size(), 1.0) {
  std::vector<std::vector<double>> relative(take.labels.size());
  for (const int length : lengths_up_to(longest, growth)) {
    for (const bool edge : {false, true}) {
      const std::vector<GapTrial> cuts = cut_trials(take, groups, length, edge, trials, seed);
      const std::vector<Outcome> outcomes = outcomes_of(take, cuts, method);
      std::array<std::vector<double>, kPlaces> pooled;
      std::vector<double> errors;
      for (std::size_t i = 0; i < cuts.size(); ++i) {
        for (std::size_t k = 0; k < outcomes[i].errors.size(); ++k) {
          const int place = place_of(cuts[i].gap.first + static_cast<int>(k), cuts[i].gap, edge, false, kPlaces);
          pooled[static_cast<std::size_t>(place)].push_back(outcomes[i].errors[k] / outcomes[i].scales[k]);
          errors.push_back(outcomes[i].errors[k]);
        }
      }
      if (errors.empty()) continue;
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
      for (std::size_t i = 0; i < cuts.size() && !edge; ++i) {
        const auto m = static_cast<std::size_t>(cuts[i].gap.marker);
        for (std::size_t k = 0; k < outcomes[i].errors.size(); ++k) {
          const int place = place_of(cuts[i].gap.first + static_cast<int>(k), cuts[i].gap, false, false, kPlaces);
          relative[m].push_back(outcomes[i].errors[k] / (outcomes[i].scales[k] * std::max(row.error[place], 1e-9)));
        }
      }
    }
  }
  constexpr double prior = 50.0;  // samples' worth of belief that all markers are alike
  for (std::size_t m = 0; m < relative.size(); ++m) {
    const auto n = static_cast<double>(relative[m].size());
    if (n > 0.0) marker_factor_[m] = (n * quantile(relative[m], kCovered) + prior) / (n + prior);
  }
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
  return marker_factor_[static_cast<std::size_t>(gap.marker)] * scale * error;
}

double GapErrors::typical(int length) const {
  return interpolated(inside_, length, [](const Row& row) { return row.typical; });
}

}  // namespace vultus::mocap
