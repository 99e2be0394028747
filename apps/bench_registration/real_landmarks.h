#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>

namespace vultus::apps::bench {

/// Points of the 68-point scheme on a scan, as somebody placed them: index → position, scan frame.
using PlacedLandmarks = std::map<int, Eigen::Vector3d>;

/// Menpo's .ljson with the groups chin, leyebrow, reyebrow, nose, leye, reye and mouth ("left" as seen in the picture),
/// which in this order are the scheme; points that are null are left out, and so is the jaw's outline, which is no
/// fixed place. Throws `InputError` for another form.
PlacedLandmarks read_ljson(const std::filesystem::path& file);

/// Meshmonk's five: inner corners of right and left eye, tip of the nose, right and left corner of the mouth; one
/// "x,y,z" a line. Throws `InputError` for another form.
PlacedLandmarks read_five_points(const std::filesystem::path& file);

}  // namespace vultus::apps::bench
