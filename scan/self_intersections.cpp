#include "scan/self_intersections.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <Eigen/Geometry>
#include <algorithm>

namespace vultus::scan {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, int>;

using Corners = Eigen::Matrix3d;  // a column a corner

Corners corners_of(const Triangles& triangles, const Points& positions, int t) {
  Corners corners;
  for (int k = 0; k < 3; ++k) corners.col(k) = positions.row(triangles(t, k)).transpose();
  return corners;
}

bool share_a_vertex(const Triangles& triangles, int a, int b) {
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      if (triangles(a, i) == triangles(b, k)) return true;
  return false;
}

// How far `other` reaches beyond the plane of `base` on the side where it reaches less.
double reach(const Corners& base, const Corners& other) {
  const Eigen::Vector3d normal = (base.col(1) - base.col(0)).cross(base.col(2) - base.col(0)).normalized();
  const Eigen::Vector3d height = (other.colwise() - base.col(0)).transpose() * normal;
  return std::min(height.maxCoeff(), -height.minCoeff());
}

Kernel::Triangle_3 triangle_of(const Corners& corners) {
  const auto point = [&](int k) { return Kernel::Point_3(corners(0, k), corners(1, k), corners(2, k)); };
  return {point(0), point(1), point(2)};
}

}  // namespace

std::vector<std::pair<int, int>> self_intersections(const Triangles& triangles, const Points& positions, double depth) {
  std::vector<Box> boxes;
  boxes.reserve(triangles.rows());
  for (int t = 0; t < triangles.rows(); ++t) {
    const Corners corners = corners_of(triangles, positions, t);
    const Eigen::Vector3d low = corners.rowwise().minCoeff(), high = corners.rowwise().maxCoeff();
    if (!low.allFinite() || !high.allFinite()) continue;
    boxes.emplace_back(CGAL::Bbox_3(low[0], low[1], low[2], high[0], high[1], high[2]), t);
  }
  std::vector<std::pair<int, int>> pairs;
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& first, const Box& second) {
    const int a = std::min(first.info(), second.info()), b = std::max(first.info(), second.info());
    if (share_a_vertex(triangles, a, b)) return;
    const Corners one = corners_of(triangles, positions, a), other = corners_of(triangles, positions, b);
    if (std::min(reach(one, other), reach(other, one)) <= depth) return;
    if (CGAL::do_intersect(triangle_of(one), triangle_of(other))) pairs.emplace_back(a, b);
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace vultus::scan
