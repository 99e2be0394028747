#include "mocap/tracklets.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "core/statistics.h"

namespace vultus::mocap {

namespace {

constexpr double kTimesUsual = 8.0;

/// The straight continuation to `frame` from the samples at `from` and one or two steps behind it; with a single
/// sample, that sample.
Eigen::Vector3d continued(const Take& take, int column, int from, int step) {
  const Eigen::Vector3d at = take.at(from, column);
  const int behind = from + step;
  if (behind < 0 || behind >= take.frames() || !take.has(behind, column)) return at;
  const int further = behind + step;
  if (further < 0 || further >= take.frames() || !take.has(further, column)) {
    return 2.0 * at - take.at(behind, column);
  }
  return at + 0.5 * (at - take.at(further, column));  // the mean velocity of two steps: noise is hardly amplified
}

/// How far both continuations miss over the step from `frame` - 1 to `frame`; both samples are there.
double jump(const Take& take, int column, int frame) {
  const double forward = (continued(take, column, frame - 1, -1) - take.at(frame, column)).norm();
  const double backward = (continued(take, column, frame, 1) - take.at(frame - 1, column)).norm();
  return std::min(forward, backward);
}

std::vector<Tracklet> cut(const Take& take, int column, double jump_mm) {
  std::vector<float> jumps(static_cast<std::size_t>(take.frames()), 0.0F);
  std::vector<double> sampled;
  const int step = std::max(1, take.frames() / 2000);
  for (int f = 1; f < take.frames(); ++f) {
    if (!take.has(f, column) || !take.has(f - 1, column)) continue;
    jumps[static_cast<std::size_t>(f)] = static_cast<float>(jump(take, column, f));
    if (f % step == 0) sampled.push_back(jumps[static_cast<std::size_t>(f)]);
  }
  const double limit = std::max(jump_mm, sampled.empty() ? 0.0 : kTimesUsual * median(std::move(sampled)));
  std::vector<Tracklet> result;
  for (int f = 0; f < take.frames(); ++f) {
    if (!take.has(f, column)) continue;
    if (f > 0 && take.has(f - 1, column) && jumps[static_cast<std::size_t>(f)] <= limit) {
      result.back().last = f;
    } else {
      result.push_back({column, f, f});
    }
  }
  return result;
}

}  // namespace

std::vector<Tracklet> cut_tracklets(const Take& take, double jump_mm) {
  std::vector<std::vector<Tracklet>> found(take.labels.size());
  tbb::parallel_for(std::size_t{0}, found.size(),
                    [&](std::size_t c) { found[c] = cut(take, static_cast<int>(c), jump_mm); });
  std::vector<Tracklet> all;
  for (const auto& tracklets : found) all.insert(all.end(), tracklets.begin(), tracklets.end());
  return all;
}

bool is_unlabelled(const std::string& label) {
  std::string name = label.substr(label.find_last_of(':') + 1);
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  name.erase(std::remove_if(name.begin(), name.end(), [](unsigned char c) { return std::isspace(c) != 0; }),
             name.end());
  if (name.empty() || name[0] == '*') return true;
  for (const std::string stem : {"unlabeled", "unlabelled", "unnamed", "point_", "point", "u_"}) {
    if (!name.starts_with(stem)) continue;
    const std::string rest = name.substr(stem.size());
    if (std::all_of(rest.begin(), rest.end(), [](unsigned char c) { return std::isdigit(c) || c == '_'; })) return true;
  }
  return false;
}

}  // namespace vultus::mocap
