#include "mocap/key_poses.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files.h"
#include "core/statistics.h"
#include "mocap/holds.h"

namespace vultus::mocap {

namespace {

using Range = std::pair<int, int>;

/// The frames of `clean` that stand for those of the file that `value` names.
Range range_of(const std::filesystem::path& file, const std::string& pose, const nlohmann::json& value,
               const Take& clean) {
  const int frames = clean.file_frames.empty() ? clean.frames() : clean.file_frames.back() + 1;
  const bool single = value.is_number_integer();
  const bool pair =
      value.is_array() && value.size() == 2 && value[0].is_number_integer() && value[1].is_number_integer();
  if (!single && !pair) {
    throw InputError(file, "pose '" + pose + "'", "a frame number or [first, last] is expected");
  }
  const auto first = single ? value.get<std::int64_t>() : value[0].get<std::int64_t>();
  const auto last = single ? first : value[1].get<std::int64_t>();
  if (first < 0 || last < first || last >= frames) {
    throw InputError(file, "pose '" + pose + "'",
                     "frames " + std::to_string(first) + " to " + std::to_string(last) + " are not in the take of " +
                         std::to_string(frames) + " frames");
  }
  return {clean.frame_of_file(static_cast<int>(first)), clean.frame_of_file(static_cast<int>(last))};
}

void add(const Take& clean, const std::string& pose, Range hold, double score, KeyPoses& result) {
  result.poses.push_back(pose);
  result.holds.push_back(hold);
  result.file_holds.emplace_back(clean.file_of_frame(hold.first), clean.file_of_frame(hold.second));
  result.positions.push_back(mean_pose(clean, hold));
  result.spread.push_back(spread_about(clean, hold, result.positions.back()));
  result.scores.push_back(score);
  int unseen = 0;
  for (int m = 0; m < clean.markers(); ++m) unseen += !result.positions.back().row(m).allFinite();
  if (unseen > 0) {
    result.decisions.push_back("pose '" + pose + "': " + std::to_string(unseen) +
                               " markers are not seen in its frames");
  }
}

/// Cost of taking `hold` as a performed pose: rests that hardly differ from the neutral or are unsteady are unlikely.
struct Candidate {
  Range hold;
  double motion;  // RMS distance from neutral, mm
  double spread;  // mm
};

/// Chooses `count` of the candidates, in order, with the largest sum of clearness; neighbours that repeat each other
/// (the same pose held twice) count once.
std::vector<std::size_t> choose(const std::vector<Candidate>& candidates, std::size_t count) {
  const std::size_t n = candidates.size();
  constexpr double impossible = -1e18;
  std::vector<std::vector<double>> best(count + 1, std::vector<double>(n + 1, impossible));
  best[0].assign(n + 1, 0.0);
  const auto clearness = [&](std::size_t i) {
    return std::log1p(candidates[i].motion) - std::log1p(candidates[i].spread);
  };
  for (std::size_t k = 1; k <= count; ++k) {
    for (std::size_t i = k; i <= n; ++i) {
      best[k][i] = std::max(best[k][i - 1], best[k - 1][i - 1] + clearness(i - 1));
    }
  }
  std::vector<std::size_t> chosen;
  for (std::size_t k = count, i = n; k > 0; --i) {
    if (best[k][i] == best[k][i - 1]) continue;
    chosen.push_back(i - 1);
    --k;
  }
  std::reverse(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace

KeyPoses key_poses(const Take& clean, const std::filesystem::path& training_json) {
  const nlohmann::json list = read_json(training_json);
  if (!list.is_object() || !list.contains("poses") || !list["poses"].is_object() || list["poses"].empty()) {
    throw InputError(training_json, R"({"take": NAME, "poses": {"POSE": frame or [first, last], …}} is expected)");
  }
  KeyPoses result;
  result.labels = clean.labels;
  const std::vector<double> speeds = face_speeds(clean);
  std::vector<std::string> names;
  for (const auto& [pose, value] : list["poses"].items()) names.push_back(pose);
  std::stable_partition(names.begin(), names.end(), [](const std::string& name) { return name == "neutral"; });
  for (const std::string& pose : names) {
    Range hold = range_of(training_json, pose, list["poses"][pose], clean);
    if (hold.first == hold.second) hold = still_around(speeds, hold.first, static_cast<int>(0.1 * clean.rate_hz));
    add(clean, pose, hold, 1.0, result);
  }
  return result;
}

KeyPoses find_key_poses(const Take& clean, const std::vector<std::string>& poses, const HoldOptions& options) {
  std::vector<std::string> wanted;
  for (const std::string& pose : poses) {
    if (pose != "neutral") wanted.push_back(pose);
  }
  const std::vector<Range> holds = find_holds(clean, options);
  if (holds.empty())
    throw InputError("take '" + clean.name + "': the face never rests; give the frames in training.json");
  const NeutralChoice neutral = choose_neutral(clean, holds, options.least_motion_mm);
  std::vector<Candidate> candidates;
  for (const Range& hold : holds) {
    const Points pose = mean_pose(clean, hold);
    const double motion = pose_distance(pose, neutral.pose);
    if (motion >= options.least_motion_mm) candidates.push_back({hold, motion, spread_about(clean, hold, pose)});
  }
  if (candidates.size() < wanted.size()) {
    throw InputError("take '" + clean.name + "': " + std::to_string(candidates.size()) +
                     " rests away from neutral for " + std::to_string(wanted.size()) +
                     " poses; give the frames in training.json, or leave out poses that no marker shows (closed eyes "
                     "without markers on the lids)");
  }
  KeyPoses result;
  result.labels = clean.labels;
  add(clean, "neutral", neutral.hold, neutral.score, result);
  result.positions[0] = neutral.pose;
  const std::vector<std::size_t> chosen = choose(candidates, wanted.size());
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const Candidate& c = candidates[chosen[i]];
    // With one rest for each pose there is no choice to be wrong about.
    const double certainty = static_cast<double>(wanted.size()) / static_cast<double>(candidates.size());
    add(clean, wanted[i], c.hold, certainty * c.motion / (c.motion + 3.0 * c.spread), result);
  }
  if (candidates.size() > wanted.size()) {
    result.decisions.push_back("key poses: " + std::to_string(candidates.size()) + " rests for " +
                               std::to_string(wanted.size()) + " poses; the clearest were taken, in order");
  }
  return result;
}

void write_training(const std::filesystem::path& file, const std::string& take, const KeyPoses& poses) {
  nlohmann::json list = nlohmann::json::object();
  for (std::size_t i = 0; i < poses.poses.size(); ++i) {
    list[poses.poses[i]] = {poses.file_holds[i].first, poses.file_holds[i].second};
  }
  write_json(file, {{"take", take}, {"poses", list}});
}

}  // namespace vultus::mocap
