#include "mocap/stabilize.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "core/files.h"
#include "mocap/statistics.h"
#include "mocap/steady_markers.h"

namespace vultus::mocap {

namespace {

constexpr double kStartDeviation = 0.3;  // mm, of a jig marker before it is measured
constexpr double kSlackJig = 2.0;        // mm; a marker that strays more is no part of a rigid jig

std::string with_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

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

/// The jig's shape as seen in its most complete frame, refined over the take.
RigidBody jig_body(const Take& take, const std::vector<std::string>& labels, int& reference) {
  const std::vector<int> columns = columns_of(take, labels);
  if (reference < 0) reference = central_frame(take, columns);
  RigidBody body{labels, observed_rows(take, reference, columns),
                 Eigen::VectorXd::Constant(static_cast<Eigen::Index>(labels.size()), kStartDeviation)};
  const auto seen = body.positions.rowwise().sum().array().isFinite().count();
  if (seen < 3) {
    throw InputError("take '" + take.name + "': only " + std::to_string(seen) +
                     " of the jig's markers are seen in frame " + std::to_string(reference) + "; 3 are needed");
  }
  std::vector<int> frames = sampled_frames(take, 1000);
  return refine_body(take, body, reference, frames);
}

/// Drops markers that are not rigid with the others.
RigidBody rigid_part(const RigidBody& body, std::vector<std::string>& decisions) {
  std::vector<int> rows;
  for (int m = 0; m < body.positions.rows(); ++m) {
    if (body.positions.row(m).allFinite() && body.deviations(m) <= kSlackJig) {
      rows.push_back(m);
    } else {
      decisions.push_back("head: jig marker " + body.labels[static_cast<std::size_t>(m)] + " strays " +
                          with_digits(body.deviations(m)) + " mm from the others and is not used");
    }
  }
  RigidBody result{{}, body.positions(rows, Eigen::all), body.deviations(rows)};
  for (const int row : rows) result.labels.push_back(body.labels[static_cast<std::size_t>(row)]);
  return result;
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

/// Local frame of three markers (Zhu 2006 §6.1): origin at the first, x towards the second, z normal to the three.
std::optional<Similarity> three_point_frame(const Points& p) {
  if (!p.topRows(3).allFinite()) return {};
  const Eigen::Vector3d a = p.row(0), x = (p.row(1) - p.row(0)).transpose().normalized();
  const Eigen::Vector3d across = x.cross(Eigen::Vector3d(p.row(2)) - a);
  if (across.norm() < 1e-6) return {};
  Similarity frame;
  frame.rotation << x, across.normalized().cross(x), across.normalized();
  frame.translation = a;
  return frame;
}

std::vector<HeadPose> three_point_poses(const Take& take, const RigidBody& body) {
  const std::vector<int> columns = columns_of(take, body.labels);
  const auto rest = three_point_frame(body.positions);
  if (!rest) throw InputError("take '" + take.name + "': the three jig markers lie on a line");
  std::vector<HeadPose> poses(static_cast<std::size_t>(take.frames()));
  for (int f = 0; f < take.frames(); ++f) {
    const Points seen = observed_rows(take, f, columns);
    const auto frame = three_point_frame(seen);
    if (!frame) continue;
    HeadPose& pose = poses[static_cast<std::size_t>(f)];
    pose = {HeadPose::Kind::measured, *frame * rest->inverse(), 0.0, 3};
    const Points residual = transformed(pose.world_from_head, body.positions) - seen;
    pose.rms = std::sqrt(residual.topRows(3).rowwise().squaredNorm().mean());
  }
  return poses;
}

std::vector<HeadPose> robust_poses(const Take& take, const RigidBody& body) {
  const std::vector<int> columns = columns_of(take, body.labels);
  std::vector<HeadPose> poses(static_cast<std::size_t>(take.frames()));
  tbb::parallel_for(0, take.frames(), [&](int f) {
    if (const auto pose = fit_body(body, observed_rows(take, f, columns))) poses[static_cast<std::size_t>(f)] = *pose;
  });
  return poses;
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

Take in_head_coordinates(const Take& take, const std::vector<HeadPose>& poses, const std::vector<std::string>& drop) {
  std::vector<int> kept;
  for (int m = 0; m < take.markers(); ++m) {
    const std::string& label = take.labels[static_cast<std::size_t>(m)];
    if (std::find(drop.begin(), drop.end(), label) == drop.end()) kept.push_back(m);
  }
  std::vector<std::string> labels;
  for (const int m : kept) labels.push_back(take.labels[static_cast<std::size_t>(m)]);
  Take result = Take::empty(take.name, take.rate_hz, labels, take.frames());
  result.first_frame = take.first_frame;
  result.events = take.events;
  result.decisions = take.decisions;
  result.residual_step = take.residual_step;
  if (!take.residuals.empty()) result.residuals.assign(result.present.size(), 0.0F);
  if (!take.cameras.empty()) result.cameras.assign(result.present.size(), 0);
  tbb::parallel_for(0, take.frames(), [&](int f) {
    const HeadPose& pose = poses[static_cast<std::size_t>(f)];
    if (pose.kind == HeadPose::Kind::none) return;
    const Similarity head_from_world = pose.world_from_head.inverse();
    for (std::size_t k = 0; k < kept.size(); ++k) {
      if (!take.has(f, kept[k])) continue;
      const auto m = static_cast<int>(k);
      result.set(f, m, head_from_world * take.at(f, kept[k]));
      if (!take.residuals.empty()) result.residuals[result.index(f, m)] = take.residuals[take.index(f, kept[k])];
      if (!take.cameras.empty()) result.cameras[result.index(f, m)] = take.cameras[take.index(f, kept[k])];
    }
  });
  return result;
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
  result.decisions.push_back("head: from " + joined(result.body.labels) + "; residual " + with_digits(result.rms) +
                             " mm RMS");
  if (interpolated > 0) result.decisions.push_back("head: " + std::to_string(interpolated) + " frames interpolated");
  if (none > 0) result.decisions.push_back("head: " + std::to_string(none) + " frames without a pose are holes");
}

}  // namespace

void StabilizeOptions::validate() const {
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

Stabilized stabilize(const Take& take, const StabilizeOptions& options) {
  options.validate();
  if (take.frames() == 0) throw InputError("take '" + take.name + "' holds no frames");
  Stabilized result;
  std::vector<std::string> jig = options.jig.empty() ? jig_labels(take.labels) : options.jig;
  check_labels(take, jig);
  result.method = decide(options, jig, result.decisions);
  int reference = options.reference_frame;
  if (reference >= take.frames()) {
    throw InputError("take '" + take.name + "' has no frame " + std::to_string(reference));
  }
  if (options.body) {
    result.body = *options.body;
    if (reference < 0) reference = central_frame(take, columns_of(take, result.body.labels));
  } else if (result.method == HeadMethod::steady_face) {
    std::vector<int> all(static_cast<std::size_t>(take.markers()));
    for (int m = 0; m < take.markers(); ++m) all[static_cast<std::size_t>(m)] = m;
    if (reference < 0) reference = central_frame(take, all);
    result.body = find_steady_markers(take, reference);
  } else if (result.method == HeadMethod::three_point) {
    if (jig.size() < 3) throw InputError("take '" + take.name + "': the three-point method needs three jig markers");
    const std::vector<std::string> three(jig.begin(), jig.begin() + 3);
    if (reference < 0) reference = central_frame(take, columns_of(take, three));
    result.body = {three, observed_rows(take, reference, columns_of(take, three)),
                   Eigen::VectorXd::Constant(3, kStartDeviation)};
  } else {
    if (jig.size() < 3) throw InputError("take '" + take.name + "' has no jig of 3 or more markers; name them");
    result.body = rigid_part(jig_body(take, jig, reference), result.decisions);
  }
  result.reference_frame = reference;
  const bool as_published = result.method == HeadMethod::three_point;
  result.poses = as_published ? three_point_poses(take, result.body) : robust_poses(take, result.body);
  if (!options.nose_tip.empty()) {
    check_labels(take, {options.nose_tip});
    translate_by_nose(take, take.find(options.nose_tip), reference, result.poses);
  }
  interpolate(result.poses, static_cast<int>(options.interpolate_seconds * take.rate_hz));
  result.take = in_head_coordinates(take, result.poses, jig);
  report(result);
  return result;
}

}  // namespace vultus::mocap
