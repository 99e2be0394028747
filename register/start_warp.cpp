#include "register/start_warp.h"

namespace vultus::registration {
namespace {

// Template vertices far from every anchor, so that the warp stays put where no landmark says anything.
std::vector<int> support_vertices(const Points& positions, const std::vector<bool>& fitted, const Points& anchors,
                                  double spacing) {
  std::vector<int> chosen;
  Points taken = anchors;
  for (int v = 0; v < positions.rows(); ++v) {
    if (!fitted[v] || (taken.rowwise() - positions.row(v)).rowwise().squaredNorm().minCoeff() < spacing * spacing)
      continue;
    chosen.push_back(v);
    taken.conservativeResize(taken.rows() + 1, 3);
    taken.bottomRows<1>() = positions.row(v);
  }
  return chosen;
}

}  // namespace

HeadAxis head_axis(const Points& neutral, const std::vector<bool>& fitted, const Similarity& scan_from_template) {
  std::vector<int> skin;
  for (int v = 0; v < neutral.rows(); ++v)
    if (fitted[v]) skin.push_back(v);
  const Eigen::Vector3d centre = bounds(neutral(skin, Eigen::all)).centre();
  return {scan_from_template * centre, scan_from_template.rotation * Eigen::Vector3d::UnitY()};
}

RbfMap start_warp(const Points& vertices, const std::vector<bool>& fitted, const Anchors& anchors,
                  const Similarity& scan_from_template, const ScanSurface& scan, RbfKernel kernel) {
  const Points sources = vertices(anchors.vertices, Eigen::all);
  const std::vector<int> support = support_vertices(vertices, fitted, sources, 35.0);
  const HeadAxis axis = head_axis(vertices, fitted, scan_from_template);
  Points from(sources.rows() + support.size(), 3), to(from.rows(), 3);
  from.topRows(sources.rows()) = sources;
  to.topRows(sources.rows()) = anchors.targets;
  for (std::size_t k = 0; k < support.size(); ++k) {
    const Eigen::Vector3d moved = scan_from_template * Eigen::Vector3d(vertices.row(support[k]));
    Eigen::Vector3d radial = moved - axis.point;
    radial -= axis.direction * axis.direction.dot(radial);
    from.row(sources.rows() + k) = vertices.row(support[k]);
    to.row(sources.rows() + k) = moved;
    if (radial.norm() < 1.0) continue;
    if (const auto hit = scan.along(moved, radial.normalized(), radial.normalized(), 15.0, 0.3))
      to.row(sources.rows() + k) = hit->position;
  }
  RbfMap::Options options;
  options.kernel = kernel;
  return RbfMap(from, to, options);
}

}  // namespace vultus::registration
