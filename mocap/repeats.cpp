#include "mocap/repeats.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/statistics.h"

namespace vultus::mocap {

namespace {

constexpr double kMostRepeated = 0.2;  // share of the frames
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

std::vector<Repeat> frame_repeats(const Take& take) {
  std::vector<Repeat> found;
  int repeated = 0;
  for (int f = 1; f < take.frames(); ++f) {
    if (!same_frame(take, f)) continue;
    Repeat repeat{Repeat::Kind::held, -1, f, f};
    while (repeat.last + 1 < take.frames() && same_frame(take, repeat.last + 1)) ++repeat.last;
    repeated += repeat.frames();
    f = repeat.last;
    found.push_back(repeat);
  }
  if (repeated > kMostRepeated * take.frames()) return {};
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

/// How far the marker is from where it was held once it is seen anew; 0 when that is never.
double leap_after(const Take& take, const Repeat& repeat) {
  for (int f = repeat.last + 1; f < take.frames(); ++f) {
    if (take.has(f, repeat.marker)) return (take.at(f, repeat.marker) - take.at(repeat.last, repeat.marker)).norm();
  }
  return 0.0;
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
  int held = 0;
  for (const Repeat& repeat : found) held += repeat.frames();
  if (held > kMostRepeated * seen) return {};
  if (found.empty()) return found;
  const double step = usual_step(take, marker);
  // Rounded samples rest where motion turns, too, but leave by a single step.
  std::erase_if(found, [&](const Repeat& repeat) {
    return seen * std::pow(chance, repeat.frames()) > kByChance || leap_after(take, repeat) <= kLeap * step;
  });
  return found;
}

void append_frame(const Take& from, int frame, Take& to) {
  const std::size_t first = from.index(frame, 0), n = from.labels.size();
  const auto copy = [&](const auto& source, auto& target, std::size_t width) {
    if (source.empty()) return;
    const auto begin = source.begin() + static_cast<std::ptrdiff_t>(width * first);
    target.insert(target.end(), begin, begin + static_cast<std::ptrdiff_t>(width * n));
  };
  copy(from.positions, to.positions, 3);
  copy(from.present, to.present, 1);
  copy(from.residuals, to.residuals, 1);
  copy(from.cameras, to.cameras, 1);
}

}  // namespace

std::vector<Repeat> find_repeats(const Take& take) {
  std::vector<Repeat> found = frame_repeats(take);
  std::vector<char> whole(static_cast<std::size_t>(take.frames()), 0);
  for (const Repeat& repeat : found) {
    std::fill(whole.begin() + repeat.first, whole.begin() + repeat.last + 1, char(1));
  }
  for (int m = 0; m < take.markers(); ++m) {
    const std::vector<Repeat> more = marker_repeats(take, m, whole);
    found.insert(found.end(), more.begin(), more.end());
  }
  return found;
}

Take without(const Take& take, const std::vector<Repeat>& repeats) {
  Take kept = take;
  std::vector<char> out(static_cast<std::size_t>(take.frames()), 0);
  for (const Repeat& repeat : repeats) {
    for (int f = repeat.first; f <= repeat.last; ++f) {
      if (repeat.kind == Repeat::Kind::doubled) out[static_cast<std::size_t>(f)] = 1;
      for (int m = 0; m < take.markers(); ++m) {
        if (repeat.kind == Repeat::Kind::held || (repeat.kind == Repeat::Kind::marker && m == repeat.marker)) {
          kept.drop(f, m);
        }
      }
    }
  }
  if (std::count(out.begin(), out.end(), char(1)) == 0) return kept;
  Take result = Take::empty(take.name, take.rate_hz, take.labels, 0);
  result.residual_step = take.residual_step;
  result.first_frame = take.first_frame;
  result.events = take.events;
  result.decisions = take.decisions;
  for (int f = 0; f < take.frames(); ++f) {
    if (!out[static_cast<std::size_t>(f)]) append_frame(kept, f, result);
  }
  return result;
}

std::string name_of(Repeat::Kind kind) {
  return kind == Repeat::Kind::held ? "held" : kind == Repeat::Kind::doubled ? "doubled" : "marker";
}

}  // namespace vultus::mocap
