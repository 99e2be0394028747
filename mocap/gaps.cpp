#include "mocap/gaps.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "core/error.h"
#include "mocap/gap_errors.h"
#include "mocap/gap_methods.h"
#include "mocap/gap_regression.h"
#include "mocap/gap_trials.h"

namespace vultus::mocap {

namespace {

constexpr int kLongestTrial = 1024;       // frames; errors of longer gaps grow from there
constexpr int kRegressionTrials = 80;     // of each length: regression costs some milliseconds a gap
constexpr int kManyGaps = 4000;           // above this, short gaps are left to splines for speed
constexpr int kFewGaps = 500;             // up to this, long gaps are guessed twice
constexpr double kWorthRegression = 0.8;  // of the spline's error

bool at_edge(const Take& take, const Gap& gap) { return gap.first == 0 || gap.last + 1 == take.frames(); }

Guess with_unit_scale(const Points& places) { return {places, Eigen::VectorXd::Ones(places.rows())}; }

/// Samples on each side that a spline's velocities are fitted to, by trial: few on smooth takes, more on noisy ones.
int best_spline_window(const Take& take, const RigidGroups& groups, int length, std::uint64_t seed) {
  const std::vector<GapTrial> trials = cut_trials(take, groups, std::max(1, length / 2), false, 100, seed);
  int best = 5;
  double least = std::numeric_limits<double>::infinity();
  for (const int window : {5, 2, 3, 8}) {
    double error = 0.0;
    for (const GapTrial& trial : trials) {
      const auto places = spline_fill({take, trial.hidden}, trial.gap, window);
      if (!places) continue;
      for (int f = trial.gap.first; f <= trial.gap.last; ++f) {
        error += (places->row(f - trial.gap.first).transpose() - take.at(f, trial.gap.marker)).norm();
      }
    }
    if (error < least) {
      least = error;
      best = window;
    }
  }
  return best;
}

/// The methods, ready for one take, each with what it is worth there.
class Methods {
 public:
  Methods(const Take& take, const std::vector<Gap>& gaps, const FillOptions& options)
      : take_(take),
        options_(options),
        groups_(take),
        longest_spline_(static_cast<int>(std::floor(options.spline_seconds * take.rate_hz + 1e-9))) {
    int longest = 1, others = 0;
    for (const Gap& gap : gaps) {
      if (gap.frames() < take.frames()) longest = std::max(longest, gap.frames());
      others += !is_short(gap);
    }
    longest = std::min({longest, kLongestTrial, std::max(1, take.frames() / 2)});
    window_ = best_spline_window(take, groups_, longest_spline_, options.seed);
    spline_errors_ = errors(
        gaps, [this](const TakeView& v, const Gap& g) { return spline(v, g); }, std::max(1, longest_spline_),
        options.trials, 2, 0);
    group_errors_ = errors(
        gaps, [this](const TakeView& v, const Gap& g) { return rigid_group(v, g); }, longest, options.trials, 2, 1);
    const bool few = gaps.size() <= kManyGaps;
    const bool wanted = options.method == GapMethod::low_rank || options.method == GapMethod::automatic;
    if (!wanted || (others == 0 && !few)) return;
    first_pass(gaps);
    // Cost grows with the cube of the frames used: spend what the number of gaps allows.
    regression_ = std::make_unique<GapRegression>(take, guess_, std::clamp(400000 / std::max(1, others), 60, 160));
    if (others <= kFewGaps) second_pass(gaps);
    fit_kernels(gaps);
    regression_errors_ = errors(
        gaps, [this](const TakeView& v, const Gap& g) { return low_rank(v, g); }, longest,
        std::min(options.trials, kRegressionTrials), 3, 2);
    short_by_regression_ = few;
  }

  /// Methods to try on a gap, in order.
  std::vector<Origin> order(const Gap& gap) const {
    const bool fits_spline = gap.frames() <= longest_spline_;
    std::vector<Origin> result;
    const auto add = [&](Origin origin) {
      if (std::find(result.begin(), result.end(), origin) == result.end()) result.push_back(origin);
    };
    const double by_spline = spline_errors_->typical(gap.frames()), by_group = group_errors_->typical(gap.frames());
    const double by_regression = regression_ ? regression_errors_->typical(gap.frames()) : 1e9;
    if (options_.method == GapMethod::spline && fits_spline) add(Origin::spline);
    if (options_.method == GapMethod::low_rank && regression_) add(Origin::low_rank);
    if (options_.method == GapMethod::spline) return result;
    if (is_short(gap) && (!short_by_regression_ || by_regression > kWorthRegression * by_spline)) add(Origin::spline);
    if (options_.method == GapMethod::automatic && regression_ && by_regression <= by_group) add(Origin::low_rank);
    add(Origin::rigid_group);
    if (options_.method == GapMethod::automatic && regression_) add(Origin::low_rank);
    if (fits_spline) add(Origin::spline);
    return result;
  }

  std::optional<Guess> guess(Origin method, const Gap& gap) const {
    const TakeView view{take_, {}};
    if (method == Origin::spline) return spline(view, gap);
    return method == Origin::low_rank ? low_rank(view, gap) : rigid_group(view, gap);
  }

  double expected(Origin method, const Gap& gap, int frame, double scale) const {
    const GapErrors& known = method == Origin::spline     ? *spline_errors_
                             : method == Origin::low_rank ? *regression_errors_
                                                          : *group_errors_;
    return known.expected(take_, gap, frame, scale);
  }

 private:
  bool is_short(const Gap& gap) const { return gap.frames() <= longest_spline_ && !at_edge(take_, gap); }

  std::unique_ptr<GapErrors> errors(const std::vector<Gap>& gaps, const GapErrors::Method& method, int longest,
                                    int trials, int growth, std::uint64_t offset) const {
    return std::make_unique<GapErrors>(take_, groups_, gaps, method, longest, trials, growth, options_.seed + offset);
  }

  std::optional<Guess> spline(const TakeView& view, const Gap& gap) const {
    const auto places = spline_fill(view, gap, window_);
    return places ? std::optional<Guess>(with_unit_scale(*places)) : std::nullopt;
  }

  std::optional<Guess> rigid_group(const TakeView& view, const Gap& gap) const {
    const auto places = rigid_group_fill(view, gap, groups_, options_.group_size);
    return places ? std::optional<Guess>(with_unit_scale(*places)) : std::nullopt;
  }

  std::optional<Guess> low_rank(const TakeView& view, const Gap& gap) const {
    return regression_->fill(view, gap, kernels_[kernel_class(gap)]);
  }

  /// What predicts best differs with how far the gap's ends are away.
  std::size_t kernel_class(const Gap& gap) const {
    const double seconds = gap.frames() / take_.rate_hz;
    return seconds < 0.25 ? 0 : (seconds < 1.0 ? 1 : 2);
  }

  /// A kernel for each class of lengths; classes without gaps are not worth the trials.
  void fit_kernels(const std::vector<Gap>& gaps) {
    constexpr std::array<double, 3> seconds{0.1, 0.5, 1.5};
    std::array<bool, 3> occurs{};
    for (const Gap& gap : gaps) occurs[kernel_class(gap)] = true;
    for (std::size_t k = 0; k < seconds.size(); ++k) {
      const int length = std::max(2, static_cast<int>(seconds[k] * take_.rate_hz));
      kernels_[k] =
          regression_->prepared(occurs[k] ? regression_->fitted(groups_, length, options_.seed) : RegressionKernel{});
    }
  }

  /// All gaps filled without regard to errors: inputs for the regression.
  void first_pass(const std::vector<Gap>& gaps) {
    guess_ = take_;
    tbb::parallel_for(std::size_t{0}, gaps.size(), [&](std::size_t i) {
      const Gap& gap = gaps[i];
      auto filled = guess(is_short(gap) ? Origin::spline : Origin::rigid_group, gap);
      if (!filled && gap.frames() <= longest_spline_) filled = guess(Origin::spline, gap);
      for (int f = gap.first; filled && f <= gap.last; ++f) {
        guess_.set(f, gap.marker, filled->places.row(f - gap.first).transpose());
      }
    });
  }

  /// The guess of long gaps once more, by regression on the first: other gaps learn from these frames.
  void second_pass(const std::vector<Gap>& gaps) {
    kernels_.fill(regression_->prepared(RegressionKernel{}));
    std::vector<std::optional<Guess>> filled(gaps.size());
    tbb::parallel_for(std::size_t{0}, gaps.size(), [&](std::size_t i) {
      if (!is_short(gaps[i])) filled[i] = guess(Origin::low_rank, gaps[i]);
    });
    for (std::size_t i = 0; i < gaps.size(); ++i) {
      for (int f = gaps[i].first; filled[i] && f <= gaps[i].last; ++f) {
        guess_.set(f, gaps[i].marker, filled[i]->places.row(f - gaps[i].first).transpose());
      }
    }
  }

  const Take& take_;
  const FillOptions& options_;
  RigidGroups groups_;
  int longest_spline_, window_ = 5;
  bool short_by_regression_ = false;
  Take guess_;
  std::unique_ptr<GapRegression> regression_;
  std::array<PreparedKernel, 3> kernels_;
  std::unique_ptr<GapErrors> spline_errors_, group_errors_, regression_errors_;
};

/// What a gap is filled with; single precision, as takes are large.
struct Filling {
  std::vector<float> places, expected;  // frames × 3, frames; mm
};

/// By the first method that can and is good enough; empty when there is none.
Filling filling(const Methods& methods, const FillOptions& options, Gap& gap) {
  for (const Origin method : methods.order(gap)) {
    const auto guess = methods.guess(method, gap);
    if (!guess || !guess->places.allFinite()) continue;
    Filling result;
    double largest = 0.0;
    for (int f = gap.first; f <= gap.last; ++f) {
      const double expected = methods.expected(method, gap, f, guess->scale(f - gap.first));
      largest = std::max(largest, std::isfinite(expected) ? expected : options.hole_above_mm + 1.0);
      result.expected.push_back(static_cast<float>(expected));
      for (int c = 0; c < 3; ++c) result.places.push_back(static_cast<float>(guess->places(f - gap.first, c)));
    }
    if (!(largest <= options.hole_above_mm)) continue;
    gap.method = method;
    gap.expected_error = largest;
    return result;
  }
  return {};
}

std::vector<Filling> fillings(const Take& take, const FillOptions& options, std::vector<Gap>& gaps) {
  std::vector<Filling> result(gaps.size());
  if (gaps.empty()) return result;
  const Methods methods(take, gaps, options);
  tbb::parallel_for(std::size_t{0}, gaps.size(),
                    [&](std::size_t i) { result[i] = filling(methods, options, gaps[i]); });
  return result;
}

void put(const Gap& gap, const Filling& filling, Filled& filled) {
  for (std::size_t k = 0; k < filling.expected.size(); ++k) {
    const int f = gap.first + static_cast<int>(k);
    const std::size_t i = filled.take.index(f, gap.marker);
    std::copy_n(filling.places.data() + 3 * k, 3, filled.take.positions.data() + 3 * i);
    filled.take.present[i] = 1;
    filled.origins[i] = gap.method;
    filled.expected_errors[i] = filling.expected[k];
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

Filled fill_gaps(Take take, const FillOptions& options) {
  options.validate();
  Filled filled;
  filled.gaps = find_gaps(take);
  // What the methods hold is given back before the arrays of the result are made.
  const std::vector<Filling> found = fillings(take, options, filled.gaps);
  filled.take = std::move(take);
  filled.origins.resize(filled.take.present.size());
  std::transform(filled.take.present.begin(), filled.take.present.end(), filled.origins.begin(),
                 [](std::uint8_t here) { return here != 0 ? Origin::measured : Origin::missing; });
  filled.expected_errors.assign(filled.take.present.size(), 0.0F);
  if (filled.gaps.empty()) return filled;
  for (std::size_t i = 0; i < found.size(); ++i) put(filled.gaps[i], found[i], filled);
  const auto holes = std::count_if(filled.gaps.begin(), filled.gaps.end(),
                                   [](const Gap& gap) { return gap.method == Origin::missing; });
  filled.decisions.push_back("gaps: " + std::to_string(filled.gaps.size()) + " found, " +
                             std::to_string(filled.gaps.size() - static_cast<std::size_t>(holes)) + " filled, " +
                             std::to_string(holes) + " left as holes");
  return filled;
}

}  // namespace vultus::mocap
