#include "mocap/spikes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <tbb/parallel_for.h>

#include "core/error.h"
#include "mocap/statistics.h"

namespace vultus::mocap {

namespace {

constexpr double kAboveSurroundings = 5.0;

/// Component-wise median position and mean frame of up to `count` samples from `start` on in direction `step`, within
/// `reach` frames.
struct Side {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double frame = 0.0;
  int samples = 0;
};

Side side(const Take& take, int marker, int start, int step, int count, int reach) {
  Side result;
  std::vector<double> values[3];
  for (int i = 0; i < reach && result.samples < count; ++i) {
    const int f = start + i * step;
    if (f < 0 || f >= take.frames()) break;
    if (!take.has(f, marker)) continue;
    const Eigen::Vector3d p = take.at(f, marker);
    for (int c = 0; c < 3; ++c) values[c].push_back(p[c]);
    result.frame += f;
    ++result.samples;
  }
  if (result.samples == 0) return result;
  result.frame /= result.samples;
  for (int c = 0; c < 3; ++c) result.position[c] = median(values[c]);
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

/// The 80 % quantile of the jumps within a dozen frames on both sides of a stretch, its close neighbours left out:
/// they see the spike among their own neighbours.
double surroundings(const std::vector<double>& jumps, int first, int last, int close) {
  constexpr int reach = 12;
  std::vector<double> around;
  for (int i = close + 1; i <= close + reach; ++i) {
    if (first - i >= 0) around.push_back(jumps[static_cast<std::size_t>(first - i)]);
    if (last + i < static_cast<int>(jumps.size())) around.push_back(jumps[static_cast<std::size_t>(last + i)]);
  }
  return around.empty() ? 0.0 : quantile(std::move(around), 0.8);
}

std::vector<Spike> marker_spikes(const Take& take, int marker, const SpikeOptions& options) {
  const int longest = std::max(1, static_cast<int>(std::floor(options.longest_seconds * take.rate_hz + 1e-9)));
  std::vector<double> jumps(static_cast<std::size_t>(take.frames()), 0.0), seen;
  for (int f = 0; f < take.frames(); ++f) {
    if (!take.has(f, marker)) continue;
    // The least over the possible lengths: neighbours that are part of the spike must not hide or spread it.
    double least = std::numeric_limits<double>::infinity();
    for (int skip = 0; skip < longest; ++skip) {
      if (const auto distance = jump(take, marker, f, skip, longest)) least = std::min(least, *distance);
    }
    if (!std::isfinite(least)) continue;
    jumps[static_cast<std::size_t>(f)] = least;
    seen.push_back(least);
  }
  if (seen.size() < 8) return {};
  const double usual = std::max(options.least_mm, options.factor * median(seen));
  std::vector<Spike> spikes;
  for (int f = 0; f < take.frames(); ++f) {
    if (jumps[static_cast<std::size_t>(f)] <= usual) continue;
    int last = f;
    double size = 0.0;
    while (last < take.frames() && jumps[static_cast<std::size_t>(last)] > usual) {
      size = std::max(size, jumps[static_cast<std::size_t>(last++)]);
    }
    // A long one is fast motion, and so is one among others that nearly reach its size.
    const bool apart = size > kAboveSurroundings * surroundings(jumps, f, last - 1, longest);
    if (last - f <= longest && apart) spikes.push_back({marker, f, last - 1, size});
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

Take without(const Take& take, const std::vector<Spike>& spikes) {
  Take result = take;
  for (const Spike& spike : spikes) {
    for (int f = spike.first; f <= spike.last; ++f) result.drop(f, spike.marker);
  }
  return result;
}

}  // namespace vultus::mocap
