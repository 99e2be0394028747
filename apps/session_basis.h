#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/session_takes.h"
#include "retarget/marker_basis.h"
#include "retarget/marker_map.h"
#include "rig/actor.h"

namespace vultus::apps {

/// What a session's solves have in common: S of Liu §3.1, where its markers sit on the rig, and in which space it is.
struct SessionBasis {
  retarget::MarkerBasis basis;
  retarget::MarkerPlacement placement;
  bool from_training = false;  ///< else from the rig's own surface, in rig space
  std::vector<std::string> decisions, warnings;

  std::vector<SurfacePoint> places() const;  ///< of the basis's labels
  /// The take in the basis's space.
  mocap::Take in_space(const mocap::Take& clean) const;
};

/// The mocap actor's neutral and, from a training take, the other poses.
struct TrainingPoses {
  std::vector<std::string> labels, poses;  ///< `poses` as in the actor; the neutral first
  std::vector<Points> captured;            ///< labels×3 a pose, no rows where a pose was not captured
  std::vector<std::string> decisions;
};

/// The list of key poses that belongs to a training take: TAKE.json or training.json beside it; empty when there is
/// none.
std::filesystem::path training_list(const std::filesystem::path& take);

/// From the training take: by its list, else found automatically; then poses of the actor that move none of its markers
/// (closed eyes without markers on the lids) are left out, as the decisions say. `anchors_file` as for `session_basis`.
TrainingPoses training_poses(const SessionTake& training, const std::filesystem::path& anchors_file,
                             const rig::Actor& actor);
/// The neutral alone, from one frame of a performance (from 0), or found automatically when `frame` is -1.
TrainingPoses neutral_only(const SessionTake& take, int frame, const rig::Actor& actor);

/// Places the markers by `anchors_file` (retarget/anchors.h), else by the actor's own markers, else by landmark names,
/// and builds the basis. Throws `InputError` saying what to give when nothing tells where the markers sit.
SessionBasis session_basis(const TrainingPoses& poses, bool from_training, const std::filesystem::path& anchors_file,
                           const rig::Actor& actor);

}  // namespace vultus::apps
