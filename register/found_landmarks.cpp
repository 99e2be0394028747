#include "register/found_landmarks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/neighbours.h"
#include "register/fill.h"
#include "register/subdivide.h"

namespace vultus::registration {
namespace {

constexpr int least_found = 12;  // of the 51 inside the face: fewer do not hold a face

// The quarter turns nearest to `face_from_file`: files differ by axes, and the template's own are kept where they
// serve.
Eigen::Matrix3d quarter_turns(const Eigen::Matrix3d& face_from_file) {
  Eigen::Matrix3d best = Eigen::Matrix3d::Identity();
  double closest = -4.0;
  for (int up = 0; up < 6; ++up)
    for (int front = 0; front < 6; ++front) {
      if (up / 2 == front / 2) continue;
      const Eigen::Vector3d y = (up % 2 == 0 ? 1.0 : -1.0) * Eigen::Vector3d::Unit(up / 2);
      const Eigen::Vector3d z = (front % 2 == 0 ? 1.0 : -1.0) * Eigen::Vector3d::Unit(front / 2);
      Eigen::Matrix3d turn;
      turn.row(0) = y.cross(z);
      turn.row(1) = y;
      turn.row(2) = z;
      const double likeness = turn.cwiseProduct(face_from_file).sum();  // the trace of one against the other
      if (likeness <= closest) continue;
      closest = likeness;
      best = turn;
    }
  return best;
}

}  // namespace

Template with_seen_landmarks(Template head, const DetectedLandmarks& seen) {
  const std::vector<bool> fitted = fitted_vertices(*head.topology);
  std::vector<int> skin;
  for (int v = 0; v < head.topology->vertex_count(); ++v)
    if (fitted[v]) skin.push_back(v);
  // Control vertices keep their numbers on the refined surface, where they were seen.
  const LoopSubdivision loop(head.topology, head.subdivisions);
  const PointTree tree(loop(head.neutral)(skin, Eigen::all));
  Ibug68 scheme;
  scheme.fill(-1);
  int count = 0;
  for (const ScanLandmark& point : seen.points) {
    const auto index = ibug_index(point.name);
    if (!index || is_contour(*index)) continue;
    const int vertex = skin[tree.nearest(point.position, 1).front().index];
    if (std::ranges::find(scheme, vertex) != scheme.end()) continue;
    scheme[*index] = vertex;
    ++count;
  }
  if (count < least_found)
    throw InputError("template \"" + head.name + "\" names no landmarks and only " + std::to_string(count) +
                     " were found on its shape; write a template.json beside it that names some");
  head.ibug68 = scheme;
  head.neutral = head.neutral * quarter_turns(seen.scan_from_face.transpose()).transpose();
  return head;
}

Template with_found_landmarks(Template head, const FaceFinder& finder) {
  const LoopSubdivision loop(head.topology, head.subdivisions);
  DetectedLandmarks seen;
  try {
    seen = detect_landmarks({loop.refined(), loop(head.neutral), {}, {}}, finder);
  } catch (const InputError& problem) {
    throw InputError("template \"" + head.name + "\" names no landmarks and none were found on its shape (" +
                     problem.what() + "); write a template.json beside it that names some");
  }
  return with_seen_landmarks(std::move(head), seen);
}

}  // namespace vultus::registration
