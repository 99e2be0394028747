#include "apps/virtual_stage/point_surface.h"

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <CGAL/Advancing_front_surface_reconstruction.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

namespace vultus::virtual_stage {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

// Refuses candidates with a long edge, else ranks by the circumscribed ball as the method does by default.
struct EdgeBound {
  double longest;

  template <class Front, class Cell>
  double operator()(const Front& front, Cell& cell, int index) const {
    for (int corner = 1; corner <= 3; ++corner) {
      const auto& a = cell->vertex((index + corner) % 4)->point();
      const auto& b = cell->vertex((index + corner % 3 + 1) % 4)->point();
      if (squared_distance(a, b) > longest * longest) return front.infinity();
    }
    return front.smallest_radius_delaunay_sphere(cell, index);
  }
};

}  // namespace

Triangles surface_through(const Points& points, double max_edge) {
  std::vector<Kernel::Point_3> cloud;
  cloud.reserve(points.rows());
  for (Eigen::Index i = 0; i < points.rows(); ++i) cloud.emplace_back(points(i, 0), points(i, 1), points(i, 2));
  std::vector<std::array<std::size_t, 3>> facets;
  facets.reserve(2 * cloud.size());
  constexpr double radius_ratio_bound = 5.0, beta = 0.52;  // CGAL's defaults
  CGAL::advancing_front_surface_reconstruction(cloud.begin(), cloud.end(), std::back_inserter(facets),
                                               EdgeBound{max_edge}, radius_ratio_bound, beta);
  Triangles triangles(facets.size(), 3);
  for (std::size_t f = 0; f < facets.size(); ++f)
    for (int corner = 0; corner < 3; ++corner) triangles(f, corner) = static_cast<int>(facets[f][corner]);
  return triangles;
}

}  // namespace vultus::virtual_stage
