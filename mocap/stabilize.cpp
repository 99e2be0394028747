#include "mocap/stabilize.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "core/files.h"
#include "mocap/head_smoothing.h"
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

/// The columns of `labels` alone.
Take only(const Take& take, const std::vector<std::string>& labels) {
  Take result = Take::empty(take.name, take.rate_hz, labels, take.frames());
  const std::vector<int> columns = columns_of(take, labels);
  for (int f = 0; f < take.frames(); ++f) {
    for (std::size_t m = 0; m < labels.size(); ++m) {
      if (columns[m] >= 0 && take.has(f, columns[m])) result.set(f, static_cast<int>(m), take.at(f, columns[m]));
    }
  }
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

const std::string kMoved = " (moved)";  // a slipped marker at its new place

bool is_moved(const std::string& label) { return label.ends_with(kMoved); }

/// Median place on the body of a column that the poses do not rest on.
Eigen::RowVector3d place_on_body(const Take& take, const std::string& label, const std::vector<HeadPose>& poses) {
  const int column = take.find(label);
  std::vector<double> values[3];
  for (int f = 0; f < take.frames(); ++f) {
    const HeadPose& pose = poses[static_cast<std::size_t>(f)];
    if (!take.has(f, column) || pose.kind != HeadPose::Kind::measured) continue;
    const Eigen::Vector3d at = pose.world_from_head.inverse() * take.at(f, column);
    for (int c = 0; c < 3; ++c) values[c].push_back(at[c]);
  }
  return {quantile(std::move(values[0]), 0.5), quantile(std::move(values[1]), 0.5),
          quantile(std::move(values[2]), 0.5)};
}

/// The jig of one take, from which slipped markers are taken out one by one, the largest slip first: a loose marker
/// pulls the poses, which makes the others seem to move. Three markers always stay.
class Jig {
 public:
  Jig(const Take& take, const std::vector<std::string>& labels, const StabilizeOptions& options, Stabilized& result)
      : options_(options), result_(result), known_(options.body) {
    seen_ = only(take, known_ ? known_->labels : labels);
    firm_ = seen_.labels.size();
  }

  /// Fills `result.body`, without the rows that hold for a part of this take only.
  std::vector<HeadPose> poses() {
    while (true) {
      measure();
      std::vector<JigSlip> slips;
      if (options_.find_slips) slips = find_slips(seen_, body_, poses_, known_.has_value(), options_.slips);
      if (slips.empty()) break;
      const JigSlip largest = *std::max_element(slips.begin(), slips.end(),
                                                [](const auto& a, const auto& b) { return a.distance < b.distance; });
      if (!take_out(largest)) break;
    }
    const std::size_t rows = body_.labels.size();
    body_ = known_ ? body_ : rigid_part(body_, result_.decisions);
    if (body_.labels.size() != rows) poses_ = robust_poses(seen_, body_);
    result_.body = lasting();
    return std::move(poses_);
  }

 private:
  void measure() {
    body_ = known_ ? *known_ : jig_body(seen_, seen_.labels, result_.reference_frame);
    poses_ = robust_poses(seen_, body_);
  }

  /// False when the jig cannot do without the marker.
  bool take_out(const JigSlip& slip) {
    const std::string what =
        "head: jig marker " + slip.label + " slips by " + with_digits(slip.distance) + " mm at " + when(slip.frame);
    const bool rests = options_.reuse_slipped && !is_moved(slip.label) && slip.settled >= 0 &&
                       seen_.frames() - slip.settled > 0.5 * seen_.rate_hz;
    if (!rests && firm_ <= 3) {
      result_.decisions.push_back(what + ", but the others are too few to do without it");
      return false;
    }
    const Take before = seen_;
    seen_ = without_slipped(seen_, {slip});
    if (rests) {
      measure();  // without the marker, so that its new place is seen from the others
      measure_anew(before, slip);
      result_.decisions.push_back(what + "; it is left out until it rests at its new place, at " + when(slip.settled));
    } else {
      --firm_;
      result_.decisions.push_back(what + " and is left out from there");
    }
    if (!is_moved(slip.label)) result_.slips.push_back(slip);
    return true;
  }

  void measure_anew(const Take& before, const JigSlip& slip) {
    std::vector<std::string> labels = seen_.labels;
    labels.push_back(slip.label + kMoved);
    seen_ = only(seen_, labels);
    const int from = before.find(slip.label), to = seen_.markers() - 1;
    for (int f = slip.settled; f < before.frames(); ++f)
      if (before.has(f, from)) seen_.set(f, to, before.at(f, from));
    if (!known_) return;
    const Eigen::Index rows = known_->positions.rows();
    known_->labels.push_back(labels.back());
    known_->positions.conservativeResize(rows + 1, 3);
    known_->positions.row(rows) = place_on_body(seen_, labels.back(), poses_);
    known_->deviations.conservativeResize(rows + 1);
    known_->deviations[rows] = quantile(Eigen::VectorXd(known_->deviations.head(rows)), 0.5);
  }

  RigidBody lasting() const {
    std::vector<int> rows;
    RigidBody result;
    for (std::size_t m = 0; m < body_.labels.size(); ++m) {
      if (is_moved(body_.labels[m])) continue;
      rows.push_back(static_cast<int>(m));
      result.labels.push_back(body_.labels[m]);
    }
    result.positions = body_.positions(rows, Eigen::all);
    result.deviations = body_.deviations(rows);
    return result;
  }

  std::string when(int frame) const {
    char text[64];
    std::snprintf(text, sizeof text, "frame %d (%.2f s)", frame, frame / seen_.rate_hz);
    return text;
  }

  const StabilizeOptions& options_;
  Stabilized& result_;
  std::optional<RigidBody> known_;
  Take seen_;
  RigidBody body_;
  std::vector<HeadPose> poses_;
  std::size_t firm_ = 0;  // markers that hold to the end
};

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

/// The body that stands for the head and its poses, by `result.method`; settles the reference frame where it is open.
std::vector<HeadPose> head_poses(const Take& take, const std::vector<std::string>& jig, const StabilizeOptions& options,
                                 Stabilized& result) {
  int& reference = result.reference_frame;
  if (options.body && reference < 0) reference = central_frame(take, columns_of(take, options.body->labels));
  if (result.method == HeadMethod::jig) {
    if (!options.body && jig.size() < 3) {
      throw InputError("take '" + take.name + "' has no jig of 3 or more markers; name them");
    }
    std::vector<HeadPose> poses = Jig(take, jig, options, result).poses();
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
                   Eigen::VectorXd::Constant(3, kStartDeviation)};
  }
  return result.method == HeadMethod::three_point ? three_point_poses(take, result.body)
                                                  : robust_poses(take, result.body);
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

Stabilized stabilize(const Take& take, const StabilizeOptions& options) {
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
  result.take = in_head_coordinates(take, result.poses, jig);
  report(result);
  return result;
}

}  // namespace vultus::mocap
