#include "apps/virtual_stage/point_surface.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <unordered_map>
#include <utility>
#include <vector>

#include "apps/virtual_stage/rising_memory.h"

// Facets are visited from the cell with the lower address; cells must not lie where the allocator pleases.
#define CGAL_ALLOCATOR(T) vultus::virtual_stage::RisingAllocator<T>
#include <CGAL/Advancing_front_surface_reconstruction.h>
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

namespace vultus::virtual_stage {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

// Numbers objects in the order in which they are first met.
thread_local std::unordered_map<const void*, std::size_t> first_met;
std::size_t number_of(const void* object) { return first_met.try_emplace(object, first_met.size()).first->second; }

// CGAL's front is a set of (priority, address) pairs: equal priorities, which are common, since two edges often see the
// same triangle, would be settled by where the allocator happened to put an edge. These are settled by which edge came
// first, so that a scan is the same in every run and thread.
template <class Traits, class Base = CGAL::Triangulation_vertex_base_3<Traits>>
class FrontVertex : public CGAL::Advancing_front_surface_reconstruction_vertex_base_3<Traits, Base> {
  using Parent = CGAL::Advancing_front_surface_reconstruction_vertex_base_3<Traits, Base>;

 public:
  template <class Structure>
  struct Rebind_TDS {
    using Other = FrontVertex<Traits, typename Base::template Rebind_TDS<Structure>::Other>;
  };
  using Parent::Parent;

  struct Radius_ptr_type {
    typename Parent::criteria first = 0;
    typename Parent::IO_edge_type* second = nullptr;
    std::size_t number = 0;

    Radius_ptr_type() = default;
    Radius_ptr_type(typename Parent::criteria priority, typename Parent::IO_edge_type* edge)
        : first(priority), second(edge), number(number_of(edge)) {}
    bool operator<(const Radius_ptr_type& other) const {
      return first < other.first || (first == other.first && number < other.number);
    }
  };
};

using Delaunay = CGAL::Delaunay_triangulation_3<
    Kernel, CGAL::Triangulation_data_structure_3<FrontVertex<Kernel>,
                                                 CGAL::Advancing_front_surface_reconstruction_cell_base_3<Kernel>>>;

// Refuses candidates with a long edge, else ranks by the circumscribed ball as the method does by default.
struct EdgeBound {
  const std::vector<double>* reach;

  template <class Front, class Cell>
  double operator()(const Front& front, Cell& cell, int index) const {
    for (int corner = 1; corner <= 3; ++corner) {
      const auto a = cell->vertex((index + corner) % 4), b = cell->vertex((index + corner % 3 + 1) % 4);
      if (front.triangulation_3().is_infinite(a) || front.triangulation_3().is_infinite(b)) return front.infinity();
      const double longest = std::max((*reach)[a->id()], (*reach)[b->id()]);
      if (squared_distance(a->point(), b->point()) > longest * longest) return front.infinity();
    }
    return front.smallest_radius_delaunay_sphere(cell, index);
  }
};

}  // namespace

Triangles surface_through(const Points& points, const std::vector<double>& reach) {
  constexpr std::size_t fixed_bytes = 64 << 20, point_bytes = 16 << 10;  // some 2 kB a point are used
  const RisingMemory memory(fixed_bytes + point_bytes * static_cast<std::size_t>(points.rows()));
  std::vector<std::pair<Kernel::Point_3, std::size_t>> cloud;
  cloud.reserve(points.rows());
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    cloud.emplace_back(Kernel::Point_3(points(i, 0), points(i, 1), points(i, 2)), static_cast<std::size_t>(i));
  Delaunay delaunay(cloud.begin(), cloud.end());

  first_met.clear();
  using Front = CGAL::Advancing_front_surface_reconstruction<Delaunay, EdgeBound>;
  Front front(delaunay, EdgeBound{&reach});
  constexpr double radius_ratio_bound = 5.0, beta = 0.52;  // CGAL's defaults
  front.run(radius_ratio_bound, beta);
  std::vector<std::array<std::size_t, 3>> facets;
  CGAL::write_triple_indices(std::back_inserter(facets), front);
  first_met.clear();

  Triangles triangles(facets.size(), 3);
  for (std::size_t f = 0; f < facets.size(); ++f)
    for (int corner = 0; corner < 3; ++corner) triangles(f, corner) = static_cast<int>(facets[f][corner]);
  return triangles;
}

}  // namespace vultus::virtual_stage
