#include "rig/transfer_scale.h"

#include <cmath>
#include <string>

#include "core/error.h"
#include "rig/feature_points.h"

namespace vultus::rig {
namespace {

struct FaceDistances {
  double eyes, mouth, upper, lower;
};

Eigen::RowVector3d point(const Points& neutral, const registration::Ibug68& points, int index, const char* whose) {
  if (points[index] >= 0) return neutral.row(points[index]);
  std::string name;
  for (const auto& [number, mpeg4] : mpeg4_names())
    if (number == index) name = mpeg4;
  throw InputError(std::string("motion transfer: the ") + whose + " face has no landmark " + std::to_string(index) +
                   " of the 68-point scheme (MPEG-4 " + name + "), which its size is measured by");
}

FaceDistances distances(const Points& neutral, const registration::Ibug68& points, const char* whose) {
  const auto at = [&](int index) { return point(neutral, points, index, whose); };
  const Eigen::RowVector3d right_eye = 0.5 * (at(36) + at(39)), left_eye = 0.5 * (at(42) + at(45));
  const double eye_height = 0.5 * (right_eye.y() + left_eye.y());
  const FaceDistances found = {(left_eye - right_eye).norm(), (at(54) - at(48)).norm(),
                               std::abs(eye_height - at(33).y()), std::abs(at(33).y() - at(8).y())};
  for (double distance : {found.eyes, found.mouth, found.upper, found.lower})
    if (!(distance > 0.0))
      throw InputError(std::string("motion transfer: landmarks of the ") + whose + " face coincide");
  return found;
}

}  // namespace

TransferScale transfer_scale(const Points& source_neutral, const registration::Ibug68& source_points,
                             const Points& target_neutral, const registration::Ibug68& target_points) {
  const FaceDistances source = distances(source_neutral, source_points, "source");
  const FaceDistances target = distances(target_neutral, target_points, "target");
  return {target.eyes / source.eyes, target.mouth / source.mouth, target.upper / source.upper,
          target.lower / source.lower};
}

}  // namespace vultus::rig
