#include "apps/session_basis.h"

#include <algorithm>

#include "core/error.h"
#include "core/number_text.h"
#include "mocap/holds.h"
#include "mocap/key_poses.h"
#include "retarget/anchors.h"

namespace vultus::apps {
namespace {

namespace fs = std::filesystem;

TrainingPoses in_actor_order(const mocap::KeyPoses& found, const rig::Actor& actor) {
  TrainingPoses result{found.labels, actor.pose_names(), {}, found.decisions};
  result.captured.resize(result.poses.size());
  for (std::size_t k = 0; k < found.poses.size(); ++k) {
    const auto known = std::find(result.poses.begin(), result.poses.end(), found.poses[k]);
    if (known == result.poses.end()) {
      result.decisions.push_back("training pose \"" + found.poses[k] + "\" is not in the actor and left out");
    } else {
      result.captured[static_cast<std::size_t>(known - result.poses.begin())] = found.positions[k];
    }
  }
  return result;
}

rig::MarkerPlaces anchors_for(const std::vector<std::string>& labels, const fs::path& file, const rig::Actor& actor,
                              std::vector<std::string>& decisions) {
  if (!file.empty()) return retarget::resolve(retarget::read_anchors(file, *actor.topology), actor);
  if (!actor.markers.empty()) {
    decisions.push_back("marker places: the actor's own");
    return actor.markers;
  }
  const retarget::Anchors named = retarget::anchors_by_name(labels, actor);
  if (named.landmarks.empty() && named.places.empty()) {
    throw InputError("nothing says where the markers sit on \"" + actor.name +
                     "\"; give --markers FILE with at least 3 anchors ({\"anchors\": {\"LABEL\": \"ibug:36\", …}})");
  }
  decisions.push_back("marker places: from labels that are landmark names");
  return retarget::resolve(named, actor);
}

/// The actor's poses that move markers, as the rig has them; the others can be no rest of the training take.
std::vector<std::string> shown_poses(const mocap::Take& training, const fs::path& anchors_file, const rig::Actor& actor,
                                     std::vector<std::string>& decisions) {
  const mocap::KeyPoses neutral = mocap::find_key_poses(training, {"neutral"});
  std::vector<std::string> said_later;
  const rig::MarkerPlaces anchors = anchors_for(neutral.labels, anchors_file, actor, said_later);
  const auto placement = retarget::place_markers(neutral.labels, neutral.positions.front(), anchors, actor);
  const auto basis = retarget::basis_from_surface(actor, placement.labels, placement.places);
  const auto markers = [&](int pose) {
    return Points(basis.columns.col(pose).reshaped<Eigen::RowMajor>(basis.markers(), 3));
  };
  std::vector<std::string> shown = {basis.poses.front()};
  for (int pose = 1; pose < static_cast<int>(basis.poses.size()); ++pose) {
    const std::string& name = basis.poses[static_cast<std::size_t>(pose)];
    const double motion = mocap::pose_distance(markers(pose), markers(0));
    if (motion >= mocap::HoldOptions().least_motion_mm) {
      shown.push_back(name);
    } else {
      decisions.push_back("training pose \"" + name + "\" moves the markers by only " + number(motion, "%.1f") +
                          " mm on the rig and is left out; its weight stays zero");
    }
  }
  return shown;
}

}  // namespace

fs::path training_list(const fs::path& take) {
  fs::path own = take;
  own.replace_extension(".json");
  if (fs::exists(own)) return own;
  const fs::path shared = take.parent_path() / "training.json";
  return fs::exists(shared) ? shared : fs::path();
}

std::vector<SurfacePoint> SessionBasis::places() const {
  const rig::MarkerPlaces by_label = placement.by_label();
  std::vector<SurfacePoint> result;
  for (const std::string& label : basis.labels) result.push_back(by_label.at(label));
  return result;
}

mocap::Take SessionBasis::in_space(const mocap::Take& clean) const {
  return from_training ? clean : retarget::to_rig(clean, placement, retarget::rig_from_mocap(placement));
}

TrainingPoses training_poses(const SessionTake& training, const fs::path& anchors_file, const rig::Actor& actor) {
  const fs::path list = training_list(training.file);
  if (!list.empty()) {
    TrainingPoses result = in_actor_order(mocap::key_poses(training.clean, list), actor);
    result.decisions.push_back("training poses: " + list.filename().string());
    return result;
  }
  std::vector<std::string> left_out;
  const std::vector<std::string> shown = shown_poses(training.clean, anchors_file, actor, left_out);
  TrainingPoses result = in_actor_order(mocap::find_key_poses(training.clean, shown), actor);
  result.decisions.push_back("training poses: found automatically");
  result.decisions.insert(result.decisions.end(), left_out.begin(), left_out.end());
  return result;
}

TrainingPoses neutral_only(const SessionTake& take, int frame, const rig::Actor& actor) {
  if (frame < 0) return in_actor_order(mocap::find_key_poses(take.clean, {"neutral"}), actor);
  if (frame >= take.clean.frames()) {
    throw UsageError("--neutral " + std::to_string(frame) + ": take \"" + take.name + "\" has frames 0 to " +
                     std::to_string(take.clean.frames() - 1));
  }
  TrainingPoses result{take.clean.labels, actor.pose_names(), {}, {}};
  result.captured.resize(result.poses.size());
  result.captured.front() = take.clean.frame(frame);
  result.decisions.push_back("neutral: frame " + std::to_string(frame) + " of " + take.name);
  return result;
}

SessionBasis session_basis(const TrainingPoses& poses, bool from_training, const fs::path& anchors_file,
                           const rig::Actor& actor) {
  SessionBasis result;
  result.from_training = from_training;
  result.decisions = poses.decisions;
  const rig::MarkerPlaces anchors = anchors_for(poses.labels, anchors_file, actor, result.decisions);
  result.placement = retarget::place_markers(poses.labels, poses.captured.front(), anchors, actor);
  const retarget::MarkerPlacement& placement = result.placement;
  for (const std::string& line : placement.left_out) result.warnings.push_back("marker left out: " + line);
  for (const std::string& line : placement.suspects) result.warnings.push_back("marker place doubtful: " + line);
  if (from_training) {
    // A marker that has no place on the rig has no region to speak for.
    std::vector<int> placed;
    for (const std::string& label : placement.labels) {
      placed.push_back(
          static_cast<int>(std::find(poses.labels.begin(), poses.labels.end(), label) - poses.labels.begin()));
    }
    std::vector<Points> captured;
    for (const Points& pose : poses.captured)
      captured.push_back(pose.rows() == 0 ? Points() : Points(pose(placed, Eigen::all)));
    result.basis = retarget::basis_from_training(placement.labels, poses.poses, captured);
  } else {
    result.basis = retarget::basis_from_surface(actor, placement.labels, placement.places);
  }
  result.decisions.push_back(std::to_string(result.basis.markers()) + " markers placed, anchors fit to " +
                             number(placement.anchor_rms) + " mm");
  for (const std::string& note : result.basis.notes) result.decisions.push_back(note);
  return result;
}

}  // namespace vultus::apps
