#include "mocap/frame_times.h"

#include <algorithm>
#include <cmath>

#include "core/number_text.h"
#include "core/statistics.h"
#include "mocap/take_parts.h"

namespace vultus::mocap {

namespace {

constexpr double kOff = 0.1;             // frames off the even line that call for interpolation
constexpr double kRateTolerance = 2e-4;  // below this, 2.4 ms in the ten minutes of a take, a rate is as stated
constexpr double kOneFrame = 0.5;        // of a frame: nearer than this two times are one

/// Frame number on the even line for each frame as read: leaps counted in whole frames of `period`.
std::vector<int> places_of(const std::vector<double>& times, double period) {
  std::vector<int> places(times.size(), 0);
  for (std::size_t f = 1; f < times.size(); ++f) {
    const double step = std::min(std::round((times[f] - times[f - 1]) / period), 1e9);
    places[f] = static_cast<int>(std::min(places[f - 1] + std::max(step, 0.0), 2e9));
  }
  return places;
}

/// Slope of the least-squares line through the times at their places: seconds a frame.
double period_of(const std::vector<double>& times, const std::vector<int>& places) {
  const double n = static_cast<double>(times.size());
  double mean_place = 0.0, mean_time = 0.0, top = 0.0, bottom = 0.0;
  for (std::size_t f = 0; f < times.size(); ++f) {
    mean_place += places[f] / n;
    mean_time += times[f] / n;
  }
  for (std::size_t f = 0; f < times.size(); ++f) {
    top += (places[f] - mean_place) * (times[f] - mean_time);
    bottom += (places[f] - mean_place) * (places[f] - mean_place);
  }
  return top / bottom;
}

/// Where each frame lies on the even line, in frames. The line starts where most of the first frames put it.
std::vector<double> line_places(const std::vector<double>& times, const std::vector<int>& places, double period) {
  std::vector<double> starts;
  for (std::size_t f = 0; f < std::min<std::size_t>(times.size(), 31); ++f) {
    starts.push_back(times[f] - places[f] * period);
  }
  const double start = median(std::move(starts));
  std::vector<double> result;
  for (const double time : times) result.push_back((time - start) / period);
  return result;
}

/// A take read at `at` (frames on the even line, not falling), as it is at 0, 1, 2, …
class EvenTake {
 public:
  /// Frames within `near` of a place are used as they are.
  EvenTake(const Take& read, const std::vector<double>& at, double near) : read_(read), at_(at), near_(near) {}

  Take take() {
    Take result = read_;
    const auto frames = static_cast<std::size_t>(std::max(0.0, std::floor(at_.back() + kOneFrame)) + 1.0);
    const std::size_t samples = frames * read_.labels.size();
    result.positions.assign(3 * samples, 0.0F);
    result.present.assign(samples, 0);
    if (!read_.residuals.empty()) result.residuals.assign(samples, 0.0F);
    if (!read_.cameras.empty()) result.cameras.assign(samples, 0);
    result.file_frames.resize(frames);
    int before = 0;  // the last frame not after the even time
    for (int f = 0; f < static_cast<int>(frames); ++f) {
      while (before + 1 < read_.frames() && at_[static_cast<std::size_t>(before) + 1] <= f) ++before;
      put(f, before, result);
      const int after = std::min(before + 1, read_.frames() - 1);
      const bool from_after = at(after) - f <= kOneFrame && at(after) - f < f - at(before);
      result.file_frames[static_cast<std::size_t>(f)] = from_after ? after : before;
    }
    return result;
  }
  std::size_t interpolated() const { return interpolated_; }
  std::size_t missing() const { return missing_; }
  std::size_t used() const { return used_; }  ///< frames as read that stand in the result as they are

 private:
  double at(int frame) const { return at_[static_cast<std::size_t>(frame)]; }

  void put(int f, int before, Take& result) {
    const int after = std::min(before + 1, read_.frames() - 1);
    const int nearest = std::abs(at(before) - f) <= std::abs(at(after) - f) ? before : after;
    const double off = std::abs(at(nearest) - f);
    const bool leap = at(after) - at(before) > 1.5 || after == before || at(before) > f;
    if (off <= near_ || (leap && off <= kOneFrame)) return copy(nearest, f, result);
    ++(leap ? missing_ : interpolated_);
    if (leap) return;
    for (int m = 0; m < read_.markers(); ++m) {
      if (read_.has(before, m) && read_.has(after, m)) {
        result.set(f, m, between(before, after, f, m));
      } else if (read_.has(nearest, m) && off <= kOneFrame) {
        result.set(f, m, read_.at(nearest, m));
      }
    }
  }

  void copy(int from, int to, Take& result) {
    ++used_;
    for (int m = 0; m < read_.markers(); ++m) copy_sample(read_, read_.index(from, m), result, result.index(to, m));
  }

  /// Cubic Hermite between two frames, slopes from the frames beside them where those have the marker.
  Eigen::Vector3d between(int first, int second, int f, int marker) const {
    const auto slope = [&](int frame) -> Eigen::Vector3d {
      const int left = frame > 0 && read_.has(frame - 1, marker) ? frame - 1 : frame;
      const int right = frame + 1 < read_.frames() && read_.has(frame + 1, marker) ? frame + 1 : frame;
      return (read_.at(right, marker) - read_.at(left, marker)) / std::max(1e-6, at(right) - at(left));
    };
    const double span = at(second) - at(first), u = (f - at(first)) / span, u2 = u * u, u3 = u2 * u;
    return (2 * u3 - 3 * u2 + 1) * read_.at(first, marker) + (u3 - 2 * u2 + u) * span * slope(first) +
           (3 * u2 - 2 * u3) * read_.at(second, marker) + (u3 - u2) * span * slope(second);
  }

  const Take& read_;
  const std::vector<double>& at_;
  double near_;
  std::size_t interpolated_ = 0, missing_ = 0, used_ = 0;
};

double median_step(const std::vector<double>& times) {
  std::vector<double> steps;
  for (std::size_t f = 1; f < times.size(); ++f) steps.push_back(times[f] - times[f - 1]);
  return median(std::move(steps));
}

/// True where every step is a multiple of the usual one: the digits printed hide nothing.
bool whole_steps(const std::vector<double>& times, double usual) {
  for (std::size_t f = 1; f < times.size(); ++f) {
    const double steps = (times[f] - times[f - 1]) / usual;
    if (!(std::abs(steps - std::round(steps)) < 1e-3)) return false;
  }
  return true;
}

/// The stated rate where the times' own agrees with it to their rounding.
double settled_rate(double measured, double stated, double step, double span, std::vector<std::string>& decisions) {
  const double tolerance = std::max(kRateTolerance, 2.0 * step / std::max(span, 1e-9));
  if (std::abs(measured / stated - 1.0) <= tolerance) return stated;
  decisions.push_back("rate: " + number(measured, "%.6g") + " Hz by the frames' times, not the stated " +
                      number(stated, "%.6g"));
  return measured;
}

}  // namespace

void to_even_times(Take& take, const std::vector<double>& times, double step) {
  const auto frames = static_cast<std::size_t>(take.frames());
  if (frames < 3 || times.size() != frames || !(take.rate_hz > 0.0)) return;
  const bool rising = std::is_sorted(times.begin(), times.end()) && times.back() > times.front() &&
                      std::all_of(times.begin(), times.end(), [](double t) { return std::isfinite(t); });
  if (!rising) {
    take.decisions.push_back("times: they do not rise from frame to frame and were passed over");
    return;
  }
  const double usual = median_step(times);
  if (whole_steps(times, usual)) step = 0.0;
  if (!(usual > 2.0 * step)) return;  // printed too coarsely to say anything
  const std::vector<int> places = places_of(times, usual);
  if (static_cast<std::size_t>(places.back()) + 1 > 2 * frames) {
    take.decisions.push_back("times: they leap by more frames than the take has and were passed over");
    return;
  }
  const double period = period_of(times, places);
  take.rate_hz = settled_rate(1.0 / period, take.rate_hz, step, times.back() - times.front(), take.decisions);
  const std::vector<double> at = line_places(times, places, period);
  double off = 0.0, moved = 0.0;  // frames, at most: from whole places, and from the frame's own number
  for (std::size_t f = 0; f < frames; ++f) {
    off = std::max(off, std::abs(at[f] - std::round(at[f])));
    moved = std::max(moved, std::abs(at[f] - static_cast<double>(f)));
  }
  const double near = std::max(kOff, 0.6 * step / period);
  if (moved <= near) return;
  EvenTake evened(take, at, off <= near ? near : 0.6 * step / period);
  Take result = evened.take();
  result.decisions.push_back("times: " + std::to_string(evened.missing()) +
                             " frames left out by the file are missing, " + std::to_string(evened.interpolated()) +
                             " interpolated onto the even time line, " + std::to_string(evened.used()) + " of " +
                             std::to_string(frames) + " kept as read");
  take = std::move(result);
}

}  // namespace vultus::mocap
