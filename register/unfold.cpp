#include "register/unfold.h"

#include <algorithm>

#include "core/neighbours.h"
#include "register/fill.h"

namespace vultus::registration {

std::vector<bool> folded_triangles(const Topology& topology, const Points& reference, const Points& positions) {
  auto against = [&](const Points& pose) {
    const Points faces = triangle_normals(topology, pose), corners = vertex_normals(topology, pose);
    std::vector<bool> flags(faces.rows());
    for (int t = 0; t < faces.rows(); ++t) {
      const auto c = topology.triangles().row(t);
      flags[t] = faces.row(t).dot(corners.row(c[0]) + corners.row(c[1]) + corners.row(c[2])) < 0.0;
    }
    return flags;
  };
  const std::vector<bool> before = against(reference);
  std::vector<bool> folded = against(positions);
  for (std::size_t t = 0; t < folded.size(); ++t) folded[t] = folded[t] && !before[t];
  return folded;
}

Points unfolded(const Topology& topology, const Points& reference, const Points& positions, int rounds) {
  const Adjacency neighbours = adjacency(topology);
  Points result = positions;
  for (int round = 0; round < rounds; ++round) {
    const std::vector<bool> folded = folded_triangles(topology, reference, result);
    if (std::find(folded.begin(), folded.end(), true) == folded.end()) break;
    std::vector<bool> known(positions.rows(), true);
    for (std::size_t t = 0; t < folded.size(); ++t)
      if (folded[t])
        for (int k = 0; k < 3; ++k) known[topology.triangles()(static_cast<int>(t), k)] = false;
    for (int ring = 0; ring <= round; ++ring) {
      const std::vector<bool> inner = known;
      for (int v = 0; v < positions.rows(); ++v)
        if (!inner[v])
          for (int next : neighbours.of(v)) known[next] = false;
    }
    result = reference + fill_smoothly(topology, reference, result - reference, known);
  }
  return result;
}

}  // namespace vultus::registration
