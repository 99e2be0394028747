#include "mocap/spikes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/error.h"
#include "core/statistics.h"

namespace vultus::mocap {

namespace {

constexpr double kAboveSurroundings = 5.0;
constexpr int kMostFrames = 12;  // of a spike, whatever the rate
constexpr int kMostSamples = 2 * kMostFrames + 1;

/// Component-wise median position and mean frame of up to `count` samples from `start` on in direction `step`, within
/// `reach` frames.
struct Side {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double frame = 0.0;
  int samples = 0;
};

Side side(const Take& take, int marker, int start, int step, int count, int reach) {
  Side result;
  std::array<std::array<float, kMostSamples>, 3> values;
  for (int i = 0; i < reach && result.samples < count; ++i) {
    const int f = start + i * step;
    if (f < 0 || f >= take.frames()) break;
    if (!take.has(f, marker)) continue;
    const float* p = take.positions.data() + 3 * take.index(f, marker);
    const auto n = static_cast<std::size_t>(result.samples++);
    for (std::size_t c = 0; c < 3; ++c) values[c][n] = p[c];
    result.frame += f;
  }
  if (result.samples == 0) return result;
  result.frame /= result.samples;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto middle = values[c].begin() + result.samples / 2;
    std::nth_element(values[c].begin(), middle, values[c].begin() + result.samples);
    result.position[static_cast<Eigen::Index>(c)] = *middle;
  }
  return result;
}

/// Distance of the sample from the line between what comes before and after it, skipping `skip` frames on both sides;
/// nothing where one side is empty.
std::optional<double> jump(const Take& take, int marker, int frame, int skip, int longest) {
  const int count = 2 * longest + 1, reach = 2 * count;  // a spike on one side cannot turn that side's median
  const Side before = side(take, marker, frame - 1 - skip, -1, count, reach);
  const Side after = side(take, marker, frame + 1 + skip, 1, count, reach);
  if (before.samples == 0 || after.samples == 0) return {};
  const double t = (frame - before.frame) / (after.frame - before.frame);
  return ((1.0 - t) * before.position + t * after.position - take.at(frame, marker)).norm();
}

/// The marker's jumps, computed where they are asked for. The least over the possible lengths of a spike counts:
/// neighbours that are part of it must not hide or spread it.
class Jumps {
 public:
  Jumps(const Take& take, int marker, int longest)
      : take_(take), marker_(marker), longest_(longest), known_(static_cast<std::size_t>(take.frames()), -1.0F) {}

  /// 0 for missing samples and where one side is empty.
  double at(int frame) {
    if (frame < 0 || frame >= take_.frames() || !take_.has(frame, marker_)) return 0.0;
    float& known = known_[static_cast<std::size_t>(frame)];
    if (known < 0.0F) known = static_cast<float>(least(frame));
    return known;
  }

  /// Cheap and hardly ever below `at`: the distance from the middle of the two samples just beside the spike.
  double rough(int frame) const {
    double largest = 0.0;
    for (int reach = 1; reach <= longest_; ++reach) {
      if (frame < reach || frame + reach >= take_.frames()) break;
      if (!take_.has(frame - reach, marker_) || !take_.has(frame + reach, marker_)) return kUnknown;
      const Eigen::Vector3d middle = 0.5 * (take_.at(frame - reach, marker_) + take_.at(frame + reach, marker_));
      largest = std::max(largest, (middle - take_.at(frame, marker_)).norm());
    }
    return largest;
  }

  /// The 80 % quantile within a dozen frames on both sides of a stretch, its close neighbours left out: they see the
  /// spike among their own neighbours.
  double around(int first, int last) {
    constexpr int reach = 12;
    std::vector<double> values;
    for (int i = longest_ + 1; i <= longest_ + reach; ++i) {
      values.push_back(at(first - i));
      values.push_back(at(last + i));
    }
    return quantile(std::move(values), 0.8);
  }

 private:
  static constexpr double kUnknown = 1e9;

  double least(int frame) const {
    double smallest = std::numeric_limits<double>::infinity();
    for (int skip = 0; skip < longest_; ++skip) {
      if (const auto distance = jump(take_, marker_, frame, skip, longest_)) smallest = std::min(smallest, *distance);
    }
    return std::isfinite(smallest) ? smallest : 0.0;
  }

  const Take& take_;
  int marker_, longest_;
  std::vector<float> known_;
};

/// Median jump over frames spread through the take; negative where there are too few to say what is usual.
double usual_jump(const Take& take, int marker, Jumps& jumps) {
  const int step = std::max(1, take.frames() / 2000);
  std::vector<double> seen;
  for (int f = 0; f < take.frames(); f += step) {
    if (take.has(f, marker)) seen.push_back(jumps.at(f));
  }
  return seen.size() < 8 ? -1.0 : median(std::move(seen));
}

std::vector<Spike> marker_spikes(const Take& take, int marker, const SpikeOptions& options) {
  const int longest =
      std::clamp(static_cast<int>(std::floor(options.longest_seconds * take.rate_hz + 1e-9)), 1, kMostFrames);
  Jumps jumps(take, marker, longest);
  const double usual = usual_jump(take, marker, jumps), limit = std::max(options.least_mm, options.factor * usual);
  std::vector<Spike> spikes;
  for (int f = 0; usual >= 0.0 && f < take.frames(); ++f) {
    if (!take.has(f, marker) || jumps.rough(f) <= 0.5 * limit || jumps.at(f) <= limit) continue;
    int last = f;
    double size = 0.0;
    while (jumps.at(last) > limit) size = std::max(size, jumps.at(last++));
    // A long one is fast motion, and so is one among others that nearly reach its size.
    const bool apart = last - f <= longest && size > kAboveSurroundings * jumps.around(f, last - 1);
    if (apart) spikes.push_back({marker, f, last - 1, size});
    f = last;
  }
  return spikes;
}

}  // namespace

void SpikeOptions::validate() const {
  if (!(least_mm > 0.0)) throw UsageError("least_mm must be positive");
  if (!(factor > 1.0)) throw UsageError("factor must be above 1");
  if (!(longest_seconds >= 0.0 && longest_seconds <= 0.1)) throw UsageError("longest_seconds must be in [0, 0.1]");
}

std::vector<Spike> find_spikes(const Take& take, const SpikeOptions& options) {
  options.validate();
  std::vector<std::vector<Spike>> found(take.labels.size());
  tbb::parallel_for(std::size_t{0}, found.size(),
                    [&](std::size_t m) { found[m] = marker_spikes(take, static_cast<int>(m), options); });
  std::vector<Spike> all;
  for (const auto& spikes : found) all.insert(all.end(), spikes.begin(), spikes.end());
  return all;
}

Take without(Take take, const std::vector<Spike>& spikes) {
  for (const Spike& spike : spikes) {
    for (int f = spike.first; f <= spike.last; ++f) take.drop(f, spike.marker);
  }
  return take;
}

}  // namespace vultus::mocap
