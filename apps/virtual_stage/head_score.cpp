#include "apps/virtual_stage/head_score.h"

#include <cmath>

namespace vultus::virtual_stage {

double head_motion_left(const RecordedTake& recorded, int face_markers, const std::vector<mocap::HeadPose>& poses) {
  const Points fixed = recorded.clean.frame(0).topRows(face_markers);
  Points mean = Points::Zero(fixed.rows(), 3);
  std::vector<Points> left;
  for (std::size_t f = 0; f < poses.size(); ++f) {
    if (poses[f].kind == mocap::HeadPose::Kind::none) continue;
    left.push_back(transformed(poses[f].world_from_head.inverse() * recorded.volume_from_face[f], fixed));
    mean += left.back();
  }
  if (left.empty()) return 0.0;
  mean /= static_cast<double>(left.size());
  double sum = 0.0;
  for (const Points& points : left) sum += (points - mean).rowwise().squaredNorm().mean();
  return std::sqrt(sum / static_cast<double>(left.size()));
}

}  // namespace vultus::virtual_stage
