#include "mocap/stabilize.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <cmath>

#include "core/error.h"
#include "core/files.h"
#include "core/number_text.h"
#include "mocap/head_smoothing.h"
#include "mocap/jig.h"
#include "mocap/steady_markers.h"
#include "mocap/take_parts.h"
#include "mocap/three_point.h"

namespace vultus::mocap {

namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

void check_labels(const Take& take, const std::vector<std::string>& labels) {
  for (const std::string& label : labels) {
    if (take.find(label) < 0) {
      throw InputError("take '" + take.name + "' has no marker '" + label + "'; the nearest is '" +
                       nearest_name(label, take.labels) + "'");
    }
  }
}

HeadMethod decide(const StabilizeOptions& options, std::vector<std::string>& jig, std::vector<std::string>& decisions) {
  if (options.body && options.method == HeadMethod::automatic) {
    const bool of_jig = jig_labels(options.body->labels).size() == options.body->labels.size();
    return of_jig || !options.jig.empty() ? HeadMethod::jig : HeadMethod::steady_face;
  }
  if (options.method != HeadMethod::automatic) return options.method;
  if (jig.size() >= 3) return HeadMethod::jig;
  decisions.push_back(jig.empty() ? "head: no jig markers, so the steadiest face markers are used"
                                  : "head: only " + std::to_string(jig.size()) +
                                        " jig markers, so the steadiest face markers are used");
  jig.clear();
  return HeadMethod::steady_face;
}

/// Rotation by shortest arc, translation straight, over gaps of at most `longest` frames with a pose on both sides.
void interpolate(std::vector<HeadPose>& poses, int longest) {
  for (std::size_t f = 0; f < poses.size();) {
    if (poses[f].kind != HeadPose::Kind::none) {
      ++f;
      continue;
    }
    std::size_t end = f;
    while (end < poses.size() && poses[end].kind == HeadPose::Kind::none) ++end;
    if (f > 0 && end < poses.size() && end - f <= static_cast<std::size_t>(longest)) {
      const Similarity &before = poses[f - 1].world_from_head, &after = poses[end].world_from_head;
      const Eigen::Quaterniond q0(before.rotation), q1(after.rotation);
      for (std::size_t i = f; i < end; ++i) {
        const double t = static_cast<double>(i - f + 1) / static_cast<double>(end - f + 1);
        poses[i].kind = HeadPose::Kind::interpolated;
        poses[i].world_from_head.rotation = q0.slerp(t, q1).toRotationMatrix();
        poses[i].world_from_head.translation = (1.0 - t) * before.translation + t * after.translation;
      }
    }
    f = end;
  }
}

/// The nose tip of every frame goes where it was in the reference frame (Zhu 2006 §6.1).
void translate_by_nose(const Take& take, int nose, int reference, std::vector<HeadPose>& poses) {
  const HeadPose& rest = poses[static_cast<std::size_t>(reference)];
  if (!take.has(reference, nose) || rest.kind == HeadPose::Kind::none) {
    throw InputError("take '" + take.name + "': the nose tip is not seen in the reference frame " +
                     std::to_string(reference));
  }
  const Eigen::Vector3d place = rest.world_from_head.inverse() * take.at(reference, nose);
  for (int f = 0; f < take.frames(); ++f) {
    HeadPose& pose = poses[static_cast<std::size_t>(f)];
    if (pose.kind == HeadPose::Kind::none) continue;
    if (!take.has(f, nose)) {
      pose.kind = HeadPose::Kind::none;  // no translation is known; neighbours will bridge it
      continue;
    }
    pose.world_from_head.translation = take.at(f, nose) - pose.world_from_head.rotation * place;
  }
}

/// In place, as takes are large; frames without a pose become missing.
void to_head_coordinates(const std::vector<HeadPose>& poses, Take& take) {
  tbb::parallel_for(0, take.frames(), [&](int f) {
    const HeadPose& pose = poses[static_cast<std::size_t>(f)];
    const Similarity head_from_world = pose.world_from_head.inverse();
    for (int m = 0; m < take.markers(); ++m) {
      if (pose.kind == HeadPose::Kind::none)
        take.drop(f, m);
      else if (take.has(f, m))
        take.set(f, m, head_from_world * take.at(f, m));
    }
  });
}

void report(Stabilized& result) {
  std::vector<double> squares;
  std::size_t interpolated = 0, none = 0;
  for (const HeadPose& pose : result.poses) {
    if (pose.kind == HeadPose::Kind::measured) squares.push_back(pose.rms * pose.rms);
    interpolated += pose.kind == HeadPose::Kind::interpolated;
    none += pose.kind == HeadPose::Kind::none;
  }
  double sum = 0.0;
  for (const double square : squares) sum += square;
  result.rms = squares.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(squares.size()));
  result.decisions.push_back("head: from " + joined(result.body.labels) + "; residual " + number(result.rms, "%.3g") +
                             " mm RMS");
  if (interpolated > 0) result.decisions.push_back("head: " + std::to_string(interpolated) + " frames interpolated");
  if (none > 0) result.decisions.push_back("head: " + std::to_string(none) + " frames without a pose are holes");
}

/// The body that stands for the head and its poses, by `result.method`; settles the reference frame where it is open.
std::vector<HeadPose> head_poses(const Take& take, const std::vector<std::string>& jig, const StabilizeOptions& options,
                                 Stabilized& result) {
  int& reference = result.reference_frame;
  if (options.body && reference < 0) reference = central_frame(take, columns_of(take, options.body->labels));
  if (result.method == HeadMethod::jig) {
    if (!options.body && jig.size() < 3) {
      throw InputError("take '" + take.name + "' has no jig of 3 or more markers; name them");
    }
    std::vector<HeadPose> poses = jig_poses(take, jig, options, result);
    std::stable_sort(result.slips.begin(), result.slips.end(),
                     [](const JigSlip& a, const JigSlip& b) { return a.frame < b.frame; });
    return poses;
  }
  if (options.body) {
    result.body = *options.body;
  } else if (result.method == HeadMethod::steady_face) {
    std::vector<int> all(static_cast<std::size_t>(take.markers()));
    for (int m = 0; m < take.markers(); ++m) all[static_cast<std::size_t>(m)] = m;
    if (reference < 0) reference = central_frame(take, all);
    result.body = find_steady_markers(take, reference);
  } else {
    if (jig.size() < 3) throw InputError("take '" + take.name + "': the three-point method needs three jig markers");
    const std::vector<std::string> three(jig.begin(), jig.begin() + 3);
    if (reference < 0) reference = central_frame(take, columns_of(take, three));
    result.body = {three, observed_rows(take, reference, columns_of(take, three)),
                   Eigen::VectorXd::Constant(3, start_deviation)};
  }
  return result.method == HeadMethod::three_point ? three_point_poses(take, result.body)
                                                  : body_poses(take, result.body);
}

}  // namespace

void StabilizeOptions::validate() const {
  slips.validate();
  if (!jig.empty() && jig.size() < 3) throw UsageError("a jig needs 3 or more markers");
  if (!(interpolate_seconds >= 0.0)) throw UsageError("interpolate_seconds must not be negative");
}

std::vector<std::string> jig_labels(const std::vector<std::string>& labels) {
  std::vector<std::string> jig;
  for (const std::string& label : labels) {
    std::string name = label.substr(label.find_last_of(':') + 1);
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
    const auto starts = [&](const char* stem) { return name.starts_with(stem); };
    const bool head_band = name == "lfhd" || name == "rfhd" || name == "lbhd" || name == "rbhd";
    if (head_band || name.find("jig") != std::string::npos || starts("headband") || starts("helmet") ||
        starts("hat_")) {
      jig.push_back(label);
    }
  }
  return jig;
}

Stabilized stabilize(Take take, const StabilizeOptions& options) {
  options.validate();
  if (take.frames() == 0) throw InputError("take '" + take.name + "' holds no frames");
  Stabilized result;
  std::vector<std::string> jig = options.jig.empty() ? jig_labels(take.labels) : options.jig;
  check_labels(take, jig);
  result.method = decide(options, jig, result.decisions);
  result.reference_frame = options.reference_frame;
  if (result.reference_frame >= take.frames()) {
    throw InputError("take '" + take.name + "' has no frame " + std::to_string(result.reference_frame));
  }
  result.poses = head_poses(take, jig, options, result);
  const int longest = static_cast<int>(options.interpolate_seconds * take.rate_hz);
  interpolate(result.poses, longest);
  if (options.smooth && result.method != HeadMethod::three_point) {
    result.poses = smoothed_poses(result.poses, result.body, take.rate_hz);
  }
  if (!options.nose_tip.empty()) {
    check_labels(take, {options.nose_tip});
    translate_by_nose(take, take.find(options.nose_tip), result.reference_frame, result.poses);
    interpolate(result.poses, longest);
  }
  to_head_coordinates(result.poses, take);
  std::vector<std::uint8_t> face;
  for (const std::string& label : take.labels) face.push_back(std::find(jig.begin(), jig.end(), label) == jig.end());
  keep_markers(face, take);
  result.take = std::move(take);
  report(result);
  return result;
}

}  // namespace vultus::mocap
