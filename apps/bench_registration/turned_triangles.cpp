#include "apps/bench_registration/turned_triangles.h"

#include "apps/bench_registration/case_set.h"

namespace vultus::apps::bench {

int turned_triangles(const Topology& topology, const std::vector<bool>& marked, const Points& found,
                     const Points& truth) {
  const Points now = triangle_normals(topology, found), should = triangle_normals(topology, truth);
  int turned = 0;
  for (const int t : marked_triangles(topology, marked)) turned += now.row(t).dot(should.row(t)) < 0.0;
  return turned;
}

}  // namespace vultus::apps::bench
