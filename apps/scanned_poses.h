#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/capture.h"
#include "core/progress.h"
#include "register/consistent.h"
#include "rig/database.h"

namespace vultus::apps {

struct ScannedPoses {
  int registered = 0, reused = 0;
  std::vector<std::string> failed;  ///< "POSE: reason"
};

/// True for the files of report/ that belong to a pose.
bool is_report_of(const std::string& pose, const std::string& artefact);

/// Cleans and registers the given poses (the neutral first) and writes each to the actor with its entry of the
/// registration report (report/<pose>.json), its distances (report/<pose>.distance.npy) and a picture of them
/// (report/<pose>.png). Poses that are current stay as they are. A scan that cannot be read or registered is reported
/// in `failed`; a neutral that cannot throws. Scans run side by side, as many as `memory_bytes` allows (0: four fifths
/// of what is available); each is on disk as soon as it is finished, and what is written does not depend on the others.
ScannedPoses register_scans(const Capture& capture, const std::vector<CapturedPose>& poses,
                            const registration::Registration& registration, const std::string& template_hash,
                            const std::string& method, std::uint64_t memory_bytes, rig::ActorWriter& writer,
                            Progress& progress);

/// SHA-256 over everything of a template that registration depends on.
std::string hash_of(const registration::Template& head);

}  // namespace vultus::apps
