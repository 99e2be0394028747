#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/statistics.h"
#include "core/transform.h"
#include "mocap/gap_methods.h"

namespace vultus::mocap {

namespace {

/// Typical distance of two markers and its robust deviation; a huge deviation when they are hardly seen together.
RigidGroups::Neighbour relation(const Take& take, int a, int b, int step) {
  constexpr std::size_t least = 5;
  std::vector<double> distances;
  for (int f = 0; f < take.frames(); f += step) {
    if (take.has(f, a) && take.has(f, b)) distances.push_back((take.at(f, a) - take.at(f, b)).norm());
  }
  if (distances.size() < least) return {b, 1e9, 1e9};
  const double typical = median(distances);
  for (double& distance : distances) distance = std::abs(distance - typical);
  return {b, quantile(std::move(distances), 0.8), typical};
}

/// The rigid motion that brings the group at `from` to where it is at `to`, applied to the marker's sample at `from`.
std::optional<Eigen::Vector3d> carried(const TakeView& view, int marker, int from, int to, const RigidGroups& groups,
                                       int group_size) {
  std::vector<const RigidGroups::Neighbour*> group;
  for (const RigidGroups::Neighbour& n : groups.of(marker)) {
    if (static_cast<int>(group.size()) == group_size) break;
    if (view.has(from, n.marker) && view.has(to, n.marker)) group.push_back(&n);
  }
  if (group.size() < 3) return {};
  const auto rows = static_cast<Eigen::Index>(group.size());
  Points source(rows, 3), target(rows, 3);
  Eigen::VectorXd weights(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const RigidGroups::Neighbour& n = *group[static_cast<std::size_t>(i)];
    source.row(i) = view.at(from, n.marker).transpose();
    target.row(i) = view.at(to, n.marker).transpose();
    weights(i) = 1.0 / (n.deviation * n.deviation + 0.01 + 1e-3 * n.distance * n.distance);
  }
  try {
    return fit_similarity(source, target, Scaling::fixed, weights) * view.at(from, marker);
  } catch (const InputError&) {  // a collinear group
    return {};
  }
}

}  // namespace

RigidGroups::RigidGroups(const Take& take) : neighbours_(take.labels.size()) {
  const int step = std::max(1, take.frames() / 400);
  tbb::parallel_for(0, take.markers(), [&](int m) {
    auto& list = neighbours_[static_cast<std::size_t>(m)];
    for (int other = 0; other < take.markers(); ++other) {
      if (other == m) continue;
      const Neighbour neighbour = relation(take, m, other, step);
      if (neighbour.deviation < 1e8) list.push_back(neighbour);
    }
    // A tenth of a millimetre of change counts as much as five millimetres of distance: skin between bends too.
    const auto cost = [](const Neighbour& n) { return n.deviation + 0.02 * n.distance; };
    std::stable_sort(list.begin(), list.end(), [&](const auto& a, const auto& b) { return cost(a) < cost(b); });
  });
}

std::optional<Points> rigid_group_fill(const TakeView& view, const Gap& gap, const RigidGroups& groups,
                                       int group_size) {
  const int before = gap.first - 1, after = gap.last + 1;
  const bool left = view.has(before, gap.marker), right = view.has(after, gap.marker);
  if (!left && !right) return {};
  Points filled(gap.frames(), 3);
  for (int f = gap.first; f <= gap.last; ++f) {
    const double t = !left ? 1.0 : (!right ? 0.0 : static_cast<double>(f - before) / (after - before));
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& [from, share] : {std::pair(before, 1.0 - t), std::pair(after, t)}) {
      if (share == 0.0) continue;
      const auto place = carried(view, gap.marker, from, f, groups, group_size);
      if (!place) return {};
      sum += share * *place;
    }
    filled.row(f - gap.first) = sum.transpose();
  }
  return filled;
}

}  // namespace vultus::mocap
