#include "mocap/holds.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "core/error.h"
#include "core/statistics.h"
#include "mocap/key_poses.h"

namespace vultus::mocap {

namespace {

constexpr double kTimesUsual = 2.0;  // speed of a rest by which a part of it is a motion
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Threshold between rest and motion: the split of the logarithms of the speeds into two classes with the greatest
/// variance between them (Otsu 1979).
double rest_speed(const std::vector<double>& speeds) {
  std::vector<double> logs;
  for (const double speed : speeds) {
    if (std::isfinite(speed)) logs.push_back(std::log(std::max(speed, 1e-3)));
  }
  if (logs.empty()) return 0.0;
  std::sort(logs.begin(), logs.end());
  std::vector<double> sums(logs.size() + 1, 0.0);
  for (std::size_t i = 0; i < logs.size(); ++i) sums[i + 1] = sums[i] + logs[i];
  double best = -1.0, split = logs.back();
  const auto n = static_cast<double>(logs.size());
  for (std::size_t i = 1; i < logs.size(); ++i) {
    const auto left = static_cast<double>(i);
    const double difference = sums[i] / left - (sums.back() - sums[i]) / (n - left);
    const double between = left * (n - left) * difference * difference;
    if (between > best) {
      best = between;
      split = 0.5 * (logs[i - 1] + logs[i]);
    }
  }
  return std::exp(split);
}

using Stretch = std::pair<int, int>;

/// Stretches of at least `least` frames in which the speed stays below `limit`.
std::vector<Stretch> slower_than(double limit, const std::vector<double>& speeds, const Stretch& within, int least) {
  std::vector<Stretch> found;
  const auto slow = [&](int f) { return f <= within.second && speeds[static_cast<std::size_t>(f)] < limit; };
  for (int f = within.first; f <= within.second; ++f) {
    if (!slow(f)) continue;
    int last = f;
    while (slow(last + 1)) ++last;
    if (last - f + 1 >= least) found.emplace_back(f, last);
    f = last;
  }
  return found;
}

/// Small expressions are slower than what divides rest from motion in a take with large ones, but quick against the
/// rest around them: the parts of a rest that they lead from and to, as far as those differ.
std::vector<Stretch> rests_within(const Take& clean, const std::vector<double>& speeds, const Stretch& rest, int least,
                                  double differ_mm) {
  const double usual = median({speeds.begin() + rest.first, speeds.begin() + rest.second + 1});
  std::vector<Stretch> parts;
  for (const Stretch& part : slower_than(kTimesUsual * usual, speeds, rest, least)) {
    const bool same =
        !parts.empty() && pose_distance(mean_pose(clean, parts.back()), mean_pose(clean, part)) < differ_mm;
    if (same)
      parts.back().second = part.second;
    else
      parts.push_back(part);
  }
  return parts.size() > 1 ? parts : std::vector<Stretch>{rest};
}

/// Mean of the largest tenth, three at least: lids that close move few of a face's markers. Reorders.
double liveliest_mean(std::vector<double>& squares) {
  const std::size_t n = std::min(squares.size(), std::max<std::size_t>(3, squares.size() / 10));
  if (n == 0) return 0.0;
  std::nth_element(squares.begin(), squares.begin() + static_cast<std::ptrdiff_t>(n) - 1, squares.end(),
                   std::greater<>());
  return std::accumulate(squares.begin(), squares.begin() + static_cast<std::ptrdiff_t>(n), 0.0) /
         static_cast<double>(n);
}

}  // namespace

std::vector<double> face_speeds(const Take& clean) {
  const int reach = std::max(1, static_cast<int>(std::lround(0.03 * clean.rate_hz)));
  std::vector<double> raw(static_cast<std::size_t>(clean.frames()), kNaN), squares;
  for (int f = 0; f < clean.frames(); ++f) {
    const int before = std::max(0, f - reach), after = std::min(clean.frames() - 1, f + reach);
    squares.clear();
    for (int m = 0; m < clean.markers(); ++m) {
      if (clean.has(before, m) && clean.has(after, m))
        squares.push_back((clean.at(after, m) - clean.at(before, m)).squaredNorm());
    }
    if (2 * static_cast<int>(squares.size()) >= clean.markers() && after > before) {
      raw[static_cast<std::size_t>(f)] = std::sqrt(liveliest_mean(squares)) * clean.rate_hz / (after - before);
    }
  }
  const int half = std::max(1, static_cast<int>(std::lround(0.05 * clean.rate_hz)));
  std::vector<double> smooth(raw.size(), kNaN);
  for (int f = 0; f < clean.frames(); ++f) {
    double sum = 0.0;
    int n = 0;
    for (int i = std::max(0, f - half); i <= std::min(clean.frames() - 1, f + half); ++i) {
      if (!std::isfinite(raw[static_cast<std::size_t>(i)])) continue;
      sum += raw[static_cast<std::size_t>(i)];
      ++n;
    }
    if (n > 0) smooth[static_cast<std::size_t>(f)] = sum / n;
  }
  return smooth;
}

std::pair<int, int> still_around(const std::vector<double>& speeds, int frame, int reach) {
  const double here = speeds[static_cast<std::size_t>(frame)];
  const double limit = std::isfinite(here) ? 1.5 * here + 1.0 : 0.0;
  int first = frame, last = frame;
  const auto still = [&](int f) {
    return f >= 0 && f < static_cast<int>(speeds.size()) && std::abs(f - frame) <= reach &&
           speeds[static_cast<std::size_t>(f)] <= limit;
  };
  while (still(first - 1)) --first;
  while (still(last + 1)) ++last;
  return {first, last};
}

Points mean_pose(const Take& clean, std::pair<int, int> frames) {
  Points pose = Points::Constant(clean.markers(), 3, kNaN);
  for (int m = 0; m < clean.markers(); ++m) {
    std::vector<double> values[3];
    for (int f = frames.first; f <= frames.second; ++f) {
      if (!clean.has(f, m)) continue;
      for (int c = 0; c < 3; ++c) values[c].push_back(clean.at(f, m)[c]);
    }
    if (values[0].empty()) continue;
    // The mean of the middle half: as robust as is needed here, and less noisy than a median.
    for (int c = 0; c < 3; ++c) {
      std::sort(values[c].begin(), values[c].end());
      const std::size_t n = values[c].size(), low = n / 4, high = n - n / 4;
      double sum = 0.0;
      for (std::size_t i = low; i < high; ++i) sum += values[c][i];
      pose(m, c) = sum / static_cast<double>(high - low);
    }
  }
  return pose;
}

double spread_about(const Take& clean, std::pair<int, int> frames, const Points& pose) {
  double sum = 0.0;
  int n = 0;
  for (int f = frames.first; f <= frames.second; ++f) {
    for (int m = 0; m < clean.markers(); ++m) {
      if (!clean.has(f, m) || !pose.row(m).allFinite()) continue;
      sum += (clean.at(f, m) - Eigen::Vector3d(pose.row(m))).squaredNorm();
      ++n;
    }
  }
  return n == 0 ? 0.0 : std::sqrt(sum / n);
}

double pose_distance(const Points& a, const Points& b) {
  std::vector<double> squares;
  for (Eigen::Index m = 0; m < a.rows(); ++m) {
    if (a.row(m).allFinite() && b.row(m).allFinite()) squares.push_back((a.row(m) - b.row(m)).squaredNorm());
  }
  return squares.empty() ? std::numeric_limits<double>::infinity() : std::sqrt(liveliest_mean(squares));
}

NeutralChoice choose_neutral(const Take& clean, const std::vector<std::pair<int, int>>& holds, double tolerance) {
  std::vector<Points> poses;
  for (const auto& hold : holds) poses.push_back(mean_pose(clean, hold));
  std::size_t most = 0, best = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto like = static_cast<std::size_t>(std::count_if(
        poses.begin(), poses.end(), [&](const Points& other) { return pose_distance(poses[i], other) < tolerance; }));
    if (like > most) {
      most = like;
      best = i;
    }
  }
  NeutralChoice choice{Points::Zero(clean.markers(), 3), holds[best],
                       static_cast<double>(most) / static_cast<double>(poses.size())};
  Eigen::VectorXd seen = Eigen::VectorXd::Zero(clean.markers());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!(pose_distance(poses[i], poses[best]) < tolerance)) continue;
    const int length = holds[i].second - holds[i].first;
    if (length > choice.hold.second - choice.hold.first) choice.hold = holds[i];
    for (int m = 0; m < clean.markers(); ++m) {
      if (!poses[i].row(m).allFinite()) continue;
      choice.pose.row(m) += (length + 1) * poses[i].row(m);
      seen(m) += length + 1;
    }
  }
  for (int m = 0; m < clean.markers(); ++m) choice.pose.row(m) /= seen(m) > 0.0 ? seen(m) : kNaN;
  return choice;
}

void HoldOptions::validate() const {
  if (!(least_seconds > 0.0)) throw UsageError("least_seconds must be positive");
  if (!(least_motion_mm > 0.0)) throw UsageError("least_motion_mm must be positive");
}

std::vector<std::pair<int, int>> find_holds(const Take& clean, const HoldOptions& options) {
  options.validate();
  const std::vector<double> speeds = face_speeds(clean);
  const double limit = rest_speed(speeds);
  const int least = std::max(2, static_cast<int>(std::lround(options.least_seconds * clean.rate_hz)));
  std::vector<Stretch> holds;
  for (const Stretch& rest : slower_than(limit, speeds, {0, clean.frames() - 1}, least)) {
    const std::vector<Stretch> parts = rests_within(clean, speeds, rest, least, 0.5 * options.least_motion_mm);
    holds.insert(holds.end(), parts.begin(), parts.end());
  }
  return holds;
}

}  // namespace vultus::mocap
