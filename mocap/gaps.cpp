#include "mocap/gaps.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "mocap/gap_errors.h"
#include "mocap/gap_methods.h"

namespace vultus::mocap {

namespace {

constexpr int kLongestTrial = 1024;  // frames; errors of longer gaps grow from there

struct Filler {
  const Take& take;
  const FillOptions& options;
  RigidGroups groups;
  GapErrors spline_errors, group_errors;

  Filler(const Take& t, const FillOptions& o, int longest_spline, int longest)
      : take(t),
        options(o),
        groups(t),
        spline_errors(
            t, groups, [](const TakeView& view, const Gap& gap) { return spline_fill(view, gap); }, longest_spline,
            o.trials, o.seed),
        group_errors(
            t, groups,
            [this](const TakeView& view, const Gap& gap) {
              return rigid_group_fill(view, gap, groups, options.group_size);
            },
            longest, o.trials, o.seed + 1) {}
};

bool at_edge(const Take& take, const Gap& gap) { return gap.first == 0 || gap.last + 1 == take.frames(); }

/// Fills one gap of `filled.take` in place; samples of other markers are read from the take as measured.
void fill(const Filler& filler, int longest_spline, Gap& gap, Filled& filled) {
  const TakeView view{filler.take, {}};
  const bool short_gap = gap.frames() <= longest_spline && !at_edge(filler.take, gap);
  std::optional<Points> points;
  const GapErrors* errors = nullptr;
  if (short_gap) {
    points = spline_fill(view, gap);
    errors = &filler.spline_errors;
    gap.method = Origin::spline;
  }
  if (!points) {
    points = rigid_group_fill(view, gap, filler.groups, filler.options.group_size);
    errors = &filler.group_errors;
    gap.method = Origin::rigid_group;
  }
  if (!points && gap.frames() <= longest_spline) {
    points = spline_fill(view, gap);
    errors = &filler.spline_errors;
    gap.method = Origin::spline;
  }
  for (int f = gap.first; points && f <= gap.last; ++f) {
    gap.expected_error = std::max(gap.expected_error, errors->expected(filler.take, gap, f));
  }
  if (!points || !points->allFinite() || !(gap.expected_error <= filler.options.hole_above_mm)) {
    gap.method = Origin::missing;
    gap.expected_error = 0.0;
    return;
  }
  for (int f = gap.first; f <= gap.last; ++f) {
    const std::size_t i = filler.take.index(f, gap.marker);
    filled.take.set(f, gap.marker, points->row(f - gap.first).transpose());
    filled.origins[i] = gap.method;
    filled.expected_errors[i] = static_cast<float>(errors->expected(filler.take, gap, f));
  }
}

}  // namespace

void FillOptions::validate() const {
  if (!(spline_seconds >= 0.0)) throw UsageError("spline_seconds must not be negative");
  if (group_size < 3 || group_size > 32) throw UsageError("group_size must be 3 to 32");
  if (!(hole_above_mm > 0.0)) throw UsageError("hole_above_mm must be positive");
  if (trials < 20) throw UsageError("trials must be 20 or more");
}

std::vector<Gap> find_gaps(const Take& take) {
  std::vector<Gap> gaps;
  for (int m = 0; m < take.markers(); ++m) {
    for (int f = 0; f < take.frames(); ++f) {
      if (take.has(f, m)) continue;
      int last = f;
      while (last + 1 < take.frames() && !take.has(last + 1, m)) ++last;
      gaps.push_back({m, f, last});
      f = last;
    }
  }
  return gaps;
}

Filled fill_gaps(const Take& take, const FillOptions& options) {
  options.validate();
  Filled filled;
  filled.take = take;
  filled.gaps = find_gaps(take);
  filled.origins.resize(take.present.size());
  std::transform(take.present.begin(), take.present.end(), filled.origins.begin(),
                 [](std::uint8_t here) { return here != 0 ? Origin::measured : Origin::missing; });
  filled.expected_errors.assign(take.present.size(), 0.0F);
  if (filled.gaps.empty()) return filled;
  int longest = 1;
  for (const Gap& gap : filled.gaps) {
    if (gap.frames() < take.frames()) longest = std::max(longest, gap.frames());
  }
  const int longest_spline = static_cast<int>(std::floor(options.spline_seconds * take.rate_hz + 1e-9));
  const Filler filler(take, options, std::max(1, longest_spline),
                      std::min({longest, kLongestTrial, std::max(1, take.frames() / 2)}));
  tbb::parallel_for(std::size_t{0}, filled.gaps.size(),
                    [&](std::size_t i) { fill(filler, longest_spline, filled.gaps[i], filled); });
  const auto holes = std::count_if(filled.gaps.begin(), filled.gaps.end(),
                                   [](const Gap& gap) { return gap.method == Origin::missing; });
  filled.decisions.push_back("gaps: " + std::to_string(filled.gaps.size()) + " found, " +
                             std::to_string(filled.gaps.size() - static_cast<std::size_t>(holes)) + " filled, " +
                             std::to_string(holes) + " left as holes");
  return filled;
}

}  // namespace vultus::mocap
