#include "mocap/gap_errors.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/random.h"
#include "mocap/statistics.h"

namespace vultus::mocap {

namespace {

constexpr double kCovered = 0.7;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

struct Trial {
  Gap gap;
  std::vector<TakeView::Hidden> hidden;
  bool edge = false;
  std::vector<double> errors;  // of the gap's frames; empty when the method gave up
};

/// Four classes from the gap's end (0) to its middle, or to the far end of a gap at the take's edge.
int place_of(int frame, const Gap& gap, bool open_left, bool open_right, int places) {
  const double n = gap.frames();
  const double from_left = open_left ? kInfinite : frame - gap.first + 1,
               from_right = open_right ? kInfinite : gap.last - frame + 1;
  const double depth = std::min(from_left, from_right) / (open_left || open_right ? n : 0.5 * (n + 1.0));
  return std::clamp(static_cast<int>(depth * places - 1e-9), 0, places - 1);
}

bool seen_throughout(const Take& take, int marker, int first, int last) {
  if (first < 0 || last >= take.frames()) return false;
  for (int f = first; f <= last; ++f) {
    if (!take.has(f, marker)) return false;
  }
  return true;
}

std::optional<Trial> cut(const Take& take, const RigidGroups& groups, int length, bool edge, Random& random) {
  constexpr int attempts = 200;
  if (length + 2 > take.frames()) return {};
  for (int attempt = 0; attempt < attempts; ++attempt) {
    const int marker = random.below(take.markers()), first = random.below(take.frames() - length);
    const int before = edge ? first : first - 1;
    if (!seen_throughout(take, marker, before, first + length)) continue;
    Trial trial;
    trial.gap = {marker, first, first + length - 1};
    trial.edge = edge;
    // At an edge there is nothing before the gap: everything earlier of this marker is hidden with it.
    trial.hidden.push_back({marker, edge ? 0 : first, first + length - 1});
    const auto& neighbours = groups.of(marker);
    const auto near = std::min<std::size_t>(neighbours.size(), static_cast<std::size_t>(random.below(4)));
    for (std::size_t i = 0; i < near; ++i) trial.hidden.push_back({neighbours[i].marker, first, first + length - 1});
    return trial;
  }
  return {};
}

std::vector<int> lengths_up_to(int longest) {
  std::vector<int> lengths;
  for (int length = 1; length < longest; length *= 2) lengths.push_back(length);
  lengths.push_back(std::max(1, longest));
  return lengths;
}

}  // namespace

GapErrors::GapErrors(const Take& take, const RigidGroups& groups, const Method& method, int longest, int trials,
                     std::uint64_t seed)
    : marker_factor_(take.labels.size(), 1.0) {
  std::vector<Trial> all;
  for (const int length : lengths_up_to(longest)) {
    for (const bool edge : {false, true}) {
      Random random(seed, static_cast<std::uint64_t>(2 * length + (edge ? 1 : 0)));
      for (int i = 0; i < trials; ++i) {
        if (auto trial = cut(take, groups, length, edge, random)) all.push_back(std::move(*trial));
      }
    }
  }
  tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
    Trial& trial = all[i];
    const auto filled = method(TakeView{take, trial.hidden}, trial.gap);
    if (!filled) return;
    for (int f = trial.gap.first; f <= trial.gap.last; ++f) {
      const Eigen::Vector3d guess = filled->row(f - trial.gap.first).transpose();
      trial.errors.push_back((guess - take.at(f, trial.gap.marker)).norm());
    }
  });
  for (const int length : lengths_up_to(longest)) {
    for (const bool edge : {false, true}) {
      std::vector<double> pooled[kPlaces];
      for (const Trial& trial : all) {
        if (trial.gap.frames() != length || trial.edge != edge) continue;
        for (std::size_t i = 0; i < trial.errors.size(); ++i) {
          pooled[place_of(trial.gap.first + static_cast<int>(i), trial.gap, edge, false, kPlaces)].push_back(
              trial.errors[i]);
        }
      }
      Row row{length, {}};
      double worst = 0.0;
      for (int place = 0; place < kPlaces; ++place) {
        // Short gaps have no sample in some places; they take the next one's figure.
        worst = pooled[place].empty() ? worst : std::max(worst, quantile(pooled[place], kCovered));
        row.error[place] = worst;
      }
      if (worst > 0.0) (edge ? edge_ : inside_).push_back(row);
    }
  }
  std::vector<std::vector<double>> ratios(take.labels.size());
  for (const Trial& trial : all) {
    if (trial.edge) continue;
    for (std::size_t i = 0; i < trial.errors.size(); ++i) {
      const double pool = expected(take, trial.gap, trial.gap.first + static_cast<int>(i));
      if (pool > 0.0) ratios[static_cast<std::size_t>(trial.gap.marker)].push_back(trial.errors[i] / pool);
    }
  }
  for (std::size_t m = 0; m < ratios.size(); ++m) {
    const double n = static_cast<double>(ratios[m].size()), prior = 50.0;
    if (n > 0.0) marker_factor_[m] = (n * quantile(ratios[m], kCovered) + prior) / (n + prior);
  }
}

double GapErrors::expected(const Take& take, const Gap& gap, int frame) const {
  const bool open_left = gap.first == 0 || !take.has(gap.first - 1, gap.marker);
  const bool open_right = gap.last + 1 >= take.frames() || !take.has(gap.last + 1, gap.marker);
  const std::vector<Row>& rows = open_left || open_right ? edge_ : inside_;
  if (rows.empty()) return kInfinite;
  const int place = place_of(frame, gap, open_left, open_right, kPlaces);
  const double length = gap.frames(), factor = marker_factor_[static_cast<std::size_t>(gap.marker)];
  const auto above = std::find_if(rows.begin(), rows.end(), [&](const Row& row) { return row.length >= length; });
  if (above == rows.end()) return factor * rows.back().error[place] * length / rows.back().length;
  if (above == rows.begin()) return factor * above->error[place];
  const auto below = above - 1;
  const double t = std::log(length / below->length) / std::log(static_cast<double>(above->length) / below->length);
  return factor * ((1.0 - t) * below->error[place] + t * above->error[place]);
}

}  // namespace vultus::mocap
