#include "mocap/gap_trials.h"

#include <algorithm>
#include <optional>

#include "core/random.h"

namespace vultus::mocap {

namespace {

bool seen_throughout(const Take& take, int marker, int first, int last) {
  if (first < 0 || last >= take.frames()) return false;
  for (int f = first; f <= last; ++f) {
    if (!take.has(f, marker)) return false;
  }
  return true;
}

std::optional<GapTrial> cut(const Take& take, const RigidGroups& groups, int length, bool edge, Random& random) {
  constexpr int attempts = 200;
  if (length + 2 > take.frames()) return {};
  for (int attempt = 0; attempt < attempts; ++attempt) {
    const int marker = random.below(take.markers()), first = random.below(take.frames() - length);
    if (!seen_throughout(take, marker, edge ? first : first - 1, first + length)) continue;
    GapTrial trial;
    trial.gap = {marker, first, first + length - 1};
    trial.edge = edge;
    trial.hidden.push_back({marker, edge ? 0 : first, first + length - 1});
    const auto& neighbours = groups.of(marker);
    const auto near = std::min<std::size_t>(neighbours.size(), static_cast<std::size_t>(random.below(kTrialCrowd + 1)));
    trial.crowd = static_cast<int>(near);
    for (std::size_t i = 0; i < near; ++i) trial.hidden.push_back({neighbours[i].marker, first, first + length - 1});
    return trial;
  }
  return {};
}

}  // namespace

std::vector<GapTrial> cut_trials(const Take& take, const RigidGroups& groups, int length, bool edge, int count,
                                 std::uint64_t seed) {
  std::vector<GapTrial> trials;
  Random random(seed, static_cast<std::uint64_t>(2 * length + (edge ? 1 : 0)));
  for (int i = 0; i < count; ++i) {
    if (auto trial = cut(take, groups, length, edge, random)) trials.push_back(std::move(*trial));
  }
  return trials;
}

}  // namespace vultus::mocap
