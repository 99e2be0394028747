#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "mocap/take.h"

namespace vultus::mocap {

/// The frames of a training take that stand for the database's poses (Liu et al. 2011 §3.1).
struct KeyPoses {
  std::vector<std::string> labels;         ///< markers
  std::vector<std::string> poses;          ///< neutral first where there is one
  std::vector<Points> positions;           ///< per pose: markers×3, mm; NaN rows for markers never seen in the hold
  std::vector<std::pair<int, int>> holds;  ///< first and last frame of each pose
  std::vector<std::pair<int, int>> file_holds;  ///< the same as numbers of the file (`Take::file_frames`)
  std::vector<double> spread;                   ///< RMS distance of the hold's samples from the pose, mm
  std::vector<double> scores;                   ///< 0…1, how sure the choice is; 1 for a list by hand
  std::vector<std::string> decisions;
};

/// By hand: `training.json` of DESIGN §2 ({"take": …, "poses": {"POSE": frame or [first, last]}}, frames of the
/// captured file from 0: those that cleaning took out or put in are allowed for by `Take::file_frames`). A single frame
/// is averaged with its neighbours as long as the face is still. Throws `InputError` for frames outside the take and
/// anything malformed.
KeyPoses key_poses(const Take& clean, const std::filesystem::path& training_json);

struct HoldOptions {
  double least_seconds = 0.25;   ///< shorter rests are no holds, > 0
  double least_motion_mm = 1.0;  ///< `pose_distance` of a pose from neutral at least, > 0
  void validate() const;         ///< throws `UsageError`
};

/// Automatically: rests of the face are found by its speed, the rest that recurs most is the neutral, and the others
/// are given to `poses` (the order in which they were performed; "neutral" may be among them) so that the clearest
/// rests are used. Throws `InputError` when fewer rests than poses are found.
KeyPoses find_key_poses(const Take& clean, const std::vector<std::string>& poses, const HoldOptions& options = {});

/// The rests of the face: stretches of frames, in order.
std::vector<std::pair<int, int>> find_holds(const Take& clean, const HoldOptions& options = {});

/// Writes a list that `key_poses` reads.
void write_training(const std::filesystem::path& file, const std::string& take, const KeyPoses& poses);

}  // namespace vultus::mocap
