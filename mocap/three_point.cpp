#include "mocap/three_point.h"

#include <Eigen/Geometry>
#include <cmath>
#include <optional>

#include "core/error.h"

namespace vultus::mocap {
namespace {

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

}  // namespace

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

}  // namespace vultus::mocap
