#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/mesh.h"

namespace vultus::apps {

/// One pose of a capture.
struct CapturedPose {
  std::string name;
  std::vector<std::string> tags;  ///< FACS / ARKit / viseme names
  std::filesystem::path scan;
  std::filesystem::path landmarks;  ///< placed by hand; empty when there are none
};

/// What a user brings (DESIGN §2).
struct Capture {
  std::filesystem::path folder;
  double mm_per_unit = 0.0;                               ///< 0: not said
  Eigen::Matrix3d upright = Eigen::Matrix3d::Identity();  ///< turns the scans' up axis to +y
  std::vector<CapturedPose> poses;                        ///< neutral first, the others by name
};

/// Reads capture.json where there is one; without it every scans/<pose>.{obj,ply,stl} is a pose. Throws `InputError`
/// without a neutral, for two scans of one pose and for a malformed capture.json.
Capture read_capture(const std::filesystem::path& folder);

}  // namespace vultus::apps
