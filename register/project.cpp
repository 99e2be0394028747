#include "register/project.h"

#include <tbb/parallel_for.h>

#include <functional>

#include "core/error.h"
#include "register/fill.h"

namespace vultus::registration {
namespace {

using Direction = std::function<Eigen::Vector3d(int vertex)>;  // unit, or zero for a vertex without a ray

Projection project(const Topology& topology, const Points& positions, const std::vector<bool>& movable,
                   const ScanSurface& scan, const ProjectOptions& options, const Points& normals,
                   const Direction& direction) {
  if (!(options.max_displacement > 0.0)) throw InputError("projection: the displacement limit must be positive");
  const int n = topology.vertex_count();
  Points displacements = Points::Zero(n, 3);
  std::vector<char> hit(n, 0);  // written from several threads, hence no vector<bool>
  tbb::parallel_for(0, n, [&](int v) {
    const Eigen::Vector3d ray = movable[v] ? direction(v) : Eigen::Vector3d::Zero();
    if (ray.isZero()) return;
    const auto found =
        scan.along(positions.row(v), ray, normals.row(v), options.max_displacement, options.least_cosine);
    if (!found) return;
    displacements.row(v) = found->position.transpose() - positions.row(v);
    hit[v] = 1;
  });
  Projection result{positions, std::vector<bool>(hit.begin(), hit.end())};
  if (options.fill) displacements = fill_smoothly(topology, positions, displacements, result.hit);
  result.positions += displacements;
  return result;
}

}  // namespace

Projection project_cylindrically(const Topology& topology, const Points& positions, const std::vector<bool>& movable,
                                 const ScanSurface& scan, const Eigen::Vector3d& axis_point,
                                 const Eigen::Vector3d& axis, const ProjectOptions& options) {
  const Points normals = vertex_normals(topology, positions);
  return project(topology, positions, movable, scan, options, normals, [&](int v) -> Eigen::Vector3d {
    const Eigen::Vector3d arm = positions.row(v).transpose() - axis_point;
    const Eigen::Vector3d radial = arm - axis * axis.dot(arm);
    return radial.norm() > 1e-6 ? Eigen::Vector3d(radial.normalized()) : Eigen::Vector3d::Zero();
  });
}

Projection project_along_normals(const Topology& topology, const Points& positions, const std::vector<bool>& movable,
                                 const ScanSurface& scan, const ProjectOptions& options) {
  const Points normals = vertex_normals(topology, positions);
  return project(topology, positions, movable, scan, options, normals,
                 [&](int v) -> Eigen::Vector3d { return normals.row(v).transpose(); });
}

}  // namespace vultus::registration
