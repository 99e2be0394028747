#include "mocap/jig.h"

#include <algorithm>
#include <optional>

#include "core/error.h"
#include "core/number_text.h"
#include "core/statistics.h"
#include "mocap/steady_markers.h"

namespace vultus::mocap {
namespace {

constexpr double kSlackJig = 2.0;  // mm; a marker that strays more is no part of a rigid jig

/// The jig's shape as seen in its most complete frame, refined over the take.
RigidBody jig_body(const Take& take, const std::vector<std::string>& labels, int& reference) {
  const std::vector<int> columns = columns_of(take, labels);
  if (reference < 0) reference = central_frame(take, columns);
  RigidBody body{labels, observed_rows(take, reference, columns),
                 Eigen::VectorXd::Constant(static_cast<Eigen::Index>(labels.size()), start_deviation)};
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
                          number(body.deviations(m), "%.3g") + " mm from the others and is not used");
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
  return {median(std::move(values[0])), median(std::move(values[1])), median(std::move(values[2]))};
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
    if (body_.labels.size() != rows) poses_ = body_poses(seen_, body_);
    result_.body = lasting();
    return std::move(poses_);
  }

 private:
  void measure() {
    body_ = known_ ? *known_ : jig_body(seen_, seen_.labels, result_.reference_frame);
    poses_ = body_poses(seen_, body_);
  }

  /// False when the jig cannot do without the marker.
  bool take_out(const JigSlip& slip) {
    const std::string what =
        "head: jig marker " + slip.label + " slips by " + number(slip.distance, "%.3g") + " mm at " + when(slip.frame);
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
    return "frame " + std::to_string(frame) + " (" + number(frame / seen_.rate_hz) + " s)";
  }

  const StabilizeOptions& options_;
  Stabilized& result_;
  std::optional<RigidBody> known_;
  Take seen_;
  RigidBody body_;
  std::vector<HeadPose> poses_;
  std::size_t firm_ = 0;  // markers that hold to the end
};

}  // namespace

std::vector<HeadPose> jig_poses(const Take& take, const std::vector<std::string>& labels,
                                const StabilizeOptions& options, Stabilized& result) {
  return Jig(take, labels, options, result).poses();
}

}  // namespace vultus::mocap
