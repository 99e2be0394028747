#include "mocap/holds.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/statistics.h"
#include "mocap/key_poses.h"

namespace vultus::mocap {

namespace {

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

}  // namespace

std::vector<double> face_speeds(const Take& clean) {
  const int reach = std::max(1, static_cast<int>(std::lround(0.03 * clean.rate_hz)));
  std::vector<double> raw(static_cast<std::size_t>(clean.frames()), kNaN);
  for (int f = 0; f < clean.frames(); ++f) {
    const int before = std::max(0, f - reach), after = std::min(clean.frames() - 1, f + reach);
    double sum = 0.0;
    int n = 0;
    for (int m = 0; m < clean.markers(); ++m) {
      if (!clean.has(before, m) || !clean.has(after, m)) continue;
      sum += (clean.at(after, m) - clean.at(before, m)).squaredNorm();
      ++n;
    }
    if (2 * n >= clean.markers() && after > before) {
      raw[static_cast<std::size_t>(f)] = std::sqrt(sum / n) * clean.rate_hz / (after - before);
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

double rms_distance(const Points& a, const Points& b) {
  double sum = 0.0;
  int n = 0;
  for (Eigen::Index m = 0; m < a.rows(); ++m) {
    if (!a.row(m).allFinite() || !b.row(m).allFinite()) continue;
    sum += (a.row(m) - b.row(m)).squaredNorm();
    ++n;
  }
  return n == 0 ? std::numeric_limits<double>::infinity() : std::sqrt(sum / n);
}

NeutralChoice choose_neutral(const Take& clean, const std::vector<std::pair<int, int>>& holds, double tolerance) {
  std::vector<Points> poses;
  for (const auto& hold : holds) poses.push_back(mean_pose(clean, hold));
  std::size_t most = 0, best = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto like = static_cast<std::size_t>(std::count_if(
        poses.begin(), poses.end(), [&](const Points& other) { return rms_distance(poses[i], other) < tolerance; }));
    if (like > most) {
      most = like;
      best = i;
    }
  }
  NeutralChoice choice{Points::Zero(clean.markers(), 3), holds[best],
                       static_cast<double>(most) / static_cast<double>(poses.size())};
  Eigen::VectorXd seen = Eigen::VectorXd::Zero(clean.markers());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!(rms_distance(poses[i], poses[best]) < tolerance)) continue;
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
  std::vector<std::pair<int, int>> holds;
  for (int f = 0; f < clean.frames(); ++f) {
    if (!(speeds[static_cast<std::size_t>(f)] < limit)) continue;
    int last = f;
    while (last + 1 < clean.frames() && speeds[static_cast<std::size_t>(last + 1)] < limit) ++last;
    if (last - f + 1 >= least) holds.emplace_back(f, last);
    f = last;
  }
  return holds;
}

}  // namespace vultus::mocap
