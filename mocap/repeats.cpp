#include "mocap/repeats.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "core/named_values.h"
#include "core/statistics.h"
#include "mocap/take_parts.h"

namespace vultus::mocap {

namespace {

constexpr Named<Repeat::Kind> kKinds[] = {{Repeat::Kind::held, "held"},
                                          {Repeat::Kind::doubled, "doubled"},
                                          {Repeat::Kind::marker, "marker"},
                                          {Repeat::Kind::lower_rate, "lower_rate"}};

constexpr double kMostRepeated = 0.2;    // share of the frames, in stretches that are short
constexpr double kMostStalled = 0.9;     // share of the frames above which a take is at rest
constexpr double kStalledSeconds = 0.1;  // from here on a stretch is long
constexpr double kRegular = 0.8;         // share of the frames that must repeat in one rhythm
constexpr int kRhythm = 5;               // stretches of one length at least
constexpr double kTravel = 1.0;          // mm that the others move at least while a marker is frozen
constexpr int kLeastMarkers = 3;
constexpr int kMotionFrames = 3;    // over which motion is judged on each side
constexpr double kSure = 6.0;       // deviations of the noise between the two explanations
constexpr int kShortest = 3;        // repeats of a single marker
constexpr double kLeap = 2.0;       // usual steps by which a marker leaves a place where it was held
constexpr double kByChance = 0.01;  // expected number of such stretches in a take

bool same_sample(const Take& take, int frame, int marker) {
  const float* here = take.positions.data() + 3 * take.index(frame, marker);
  const float* before = take.positions.data() + 3 * take.index(frame - 1, marker);
  return std::equal(here, here + 3, before);
}

bool same_frame(const Take& take, int frame) {
  int seen = 0;
  for (int m = 0; m < take.markers(); ++m) {
    if (take.has(frame, m) != take.has(frame - 1, m)) return false;
    if (!take.has(frame, m)) continue;
    if (!same_sample(take, frame, m)) return false;
    ++seen;
  }
  return seen >= kLeastMarkers;
}

/// Sums over the markers seen throughout the frames on both sides of a stretch.
struct Motion {
  double along = 0.0, speed2 = 0.0, noise2 = 0.0;  ///< step·v, v·v, squared second differences
  int markers = 0;
};

std::optional<Motion> motion_across(const Take& take, const Repeat& repeat) {
  const int before = repeat.first - 1, after = repeat.last + 1;
  if (before - kMotionFrames < 0 || after + kMotionFrames >= take.frames()) return {};
  Motion motion;
  for (int m = 0; m < take.markers(); ++m) {
    bool seen = true;
    for (int i = 0; i <= kMotionFrames; ++i) seen = seen && take.has(before - i, m) && take.has(after + i, m);
    if (!seen) continue;
    const Eigen::Vector3d velocity = (take.at(before, m) - take.at(before - kMotionFrames, m) +
                                      take.at(after + kMotionFrames, m) - take.at(after, m)) /
                                     (2.0 * kMotionFrames);
    motion.along += velocity.dot(take.at(after, m) - take.at(before, m));
    motion.speed2 += velocity.squaredNorm();
    motion.noise2 += (take.at(before - 1, m) - 0.5 * (take.at(before - 2, m) + take.at(before, m))).squaredNorm();
    ++motion.markers;
  }
  return motion.markers > 0 ? std::optional<Motion>(motion) : std::nullopt;
}

Repeat::Kind kind_of(const Take& take, const Repeat& repeat) {
  const auto motion = motion_across(take, repeat);
  if (!motion) return Repeat::Kind::held;
  // A second difference of white noise has 1.5 times its variance, in each of three coordinates.
  const double noise = std::sqrt(motion->noise2 / (4.5 * motion->markers)), n = repeat.frames();
  if (n * std::sqrt(motion->speed2) < kSure * noise) return Repeat::Kind::held;
  return motion->along / motion->speed2 < 1.0 + 0.5 * n ? Repeat::Kind::doubled : Repeat::Kind::held;
}

std::vector<Repeat> repeated_stretches(const Take& take) {
  std::vector<Repeat> found;
  for (int f = 1; f < take.frames(); ++f) {
    if (!same_frame(take, f)) continue;
    Repeat repeat{Repeat::Kind::held, -1, f, f};
    while (repeat.last + 1 < take.frames() && same_frame(take, repeat.last + 1)) ++repeat.last;
    f = repeat.last;
    found.push_back(repeat);
  }
  return found;
}

/// How often each frame stands in the file when nearly all stand there equally often; 1 otherwise.
int usual_times(const Take& take, const std::vector<Repeat>& stretches) {
  std::map<int, int> counts;
  for (const Repeat& stretch : stretches) ++counts[stretch.frames()];
  for (const auto& [length, count] : counts)
    if (count >= kRhythm && count * (length + 1) > kRegular * take.frames()) return length + 1;
  return 1;
}

std::vector<Repeat> frame_repeats(const Take& take) {
  std::vector<Repeat> found = repeated_stretches(take);
  if (const int times = usual_times(take, found); times > 1) {
    return {{Repeat::Kind::lower_rate, -1, 0, take.frames() - 1, times}};
  }
  // A recording that stalls stands still for long; what repeats often for a few frames is at rest.
  const double stalled = kStalledSeconds * take.rate_hz;
  int all = 0, briefly = 0;
  for (const Repeat& stretch : found) {
    all += stretch.frames();
    briefly += stretch.frames() < stalled ? stretch.frames() : 0;
  }
  if (all > kMostStalled * take.frames()) return {};
  if (briefly > kMostRepeated * take.frames())
    std::erase_if(found, [&](const Repeat& stretch) { return stretch.frames() < stalled; });
  for (Repeat& repeat : found) repeat.kind = kind_of(take, repeat);
  return found;
}

/// Median distance between neighbouring frames that differ, mm.
double usual_step(const Take& take, int marker) {
  std::vector<double> steps;
  for (int f = 1; f < take.frames(); ++f) {
    if (!take.has(f, marker) || !take.has(f - 1, marker) || same_sample(take, f, marker)) continue;
    steps.push_back((take.at(f, marker) - take.at(f - 1, marker)).norm());
  }
  return steps.empty() ? 0.0 : median(std::move(steps));
}

/// How far the marker is from where it was held once it is seen anew; nothing when that is never.
std::optional<double> leap_after(const Take& take, const Repeat& repeat) {
  for (int f = repeat.last + 1; f < take.frames(); ++f) {
    if (take.has(f, repeat.marker)) return (take.at(f, repeat.marker) - take.at(repeat.last, repeat.marker)).norm();
  }
  return {};
}

/// Median over the other markers of how far they get from where they are as the stretch begins.
double travel_of_others(const Take& take, const Repeat& repeat) {
  std::vector<double> travels;
  const int step = std::max(1, repeat.frames() / 100);
  for (int m = 0; m < take.markers(); ++m) {
    if (m == repeat.marker || !take.has(repeat.first - 1, m)) continue;
    const Eigen::Vector3d start = take.at(repeat.first - 1, m);
    double travel = 0.0;
    for (int f = repeat.first; f <= repeat.last; f += step)
      if (take.has(f, m)) travel = std::max(travel, (take.at(f, m) - start).norm());
    travels.push_back(travel);
  }
  return travels.empty() ? 0.0 : median(std::move(travels));
}

/// Rounded samples rest where motion turns, too, but leave by a single step.
bool stands_out(const Take& take, const Repeat& repeat, double step) {
  if (const auto leap = leap_after(take, repeat)) return *leap > kLeap * step;
  return travel_of_others(take, repeat) > std::max(kTravel, kLeap * step);
}

/// `whole` marks the frames that repeat as a whole.
std::vector<Repeat> marker_repeats(const Take& take, int marker, const std::vector<char>& whole) {
  std::vector<Repeat> found;
  int seen = 0, singly = 0;
  const auto repeats = [&](int f) {
    return !whole[static_cast<std::size_t>(f)] && take.has(f, marker) && take.has(f - 1, marker) &&
           same_sample(take, f, marker);
  };
  for (int f = 1; f < take.frames(); ++f) {
    seen += take.has(f, marker);
    if (!repeats(f)) continue;
    Repeat repeat{Repeat::Kind::marker, marker, f, f};
    while (repeat.last + 1 < take.frames() && repeats(repeat.last + 1)) ++repeat.last;
    seen += repeat.frames() - 1;
    f = repeat.last;
    if (repeat.frames() < kShortest) {
      singly += repeat.frames();
    } else {
      found.push_back(repeat);
    }
  }
  // One repeat more than seen: a take without any says no more than that they are rarer than one in its length.
  const double chance = (singly + 1.0) / std::max(1, seen);
  if (found.empty()) return found;
  const double step = usual_step(take, marker);
  std::erase_if(found, [&](const Repeat& repeat) {
    return seen * std::pow(chance, repeat.frames()) > kByChance || !stands_out(take, repeat, step);
  });
  // Many short ones are a coarse file's; a marker that is frozen is so for long.
  int briefly = 0;
  const double stalled = kStalledSeconds * take.rate_hz;
  for (const Repeat& repeat : found) briefly += repeat.frames() < stalled ? repeat.frames() : 0;
  if (briefly > kMostRepeated * seen)
    std::erase_if(found, [&](const Repeat& repeat) { return repeat.frames() < stalled; });
  return found;
}

}  // namespace

std::vector<Repeat> find_repeats(const Take& take) {
  std::vector<Repeat> found = frame_repeats(take);
  std::vector<char> whole(static_cast<std::size_t>(take.frames()), 0);
  for (const Repeat& repeat : found) {
    if (repeat.kind == Repeat::Kind::lower_rate) return found;
    std::fill(whole.begin() + repeat.first, whole.begin() + repeat.last + 1, char(1));
  }
  for (int m = 0; m < take.markers(); ++m) {
    const std::vector<Repeat> more = marker_repeats(take, m, whole);
    found.insert(found.end(), more.begin(), more.end());
  }
  return found;
}

Take without(Take take, const std::vector<Repeat>& repeats) {
  std::vector<std::uint8_t> keep(static_cast<std::size_t>(take.frames()), 1);
  for (const Repeat& repeat : repeats) {
    if (repeat.kind == Repeat::Kind::lower_rate) continue;
    for (int f = repeat.first; f <= repeat.last; ++f) {
      if (repeat.kind == Repeat::Kind::doubled) keep[static_cast<std::size_t>(f)] = 0;
      for (int m = 0; m < take.markers(); ++m) {
        if (repeat.kind == Repeat::Kind::held || (repeat.kind == Repeat::Kind::marker && m == repeat.marker)) {
          take.drop(f, m);
        }
      }
    }
  }
  if (std::count(keep.begin(), keep.end(), std::uint8_t{0}) > 0) keep_frames(keep, take);
  return take;
}

std::string name_of(Repeat::Kind kind) { return name_in(kKinds, kind); }

Repeat::Kind repeat_kind(const std::string& name) { return value_named(kKinds, name, "kind of repeat"); }

}  // namespace vultus::mocap
