#include "register/calmed_normals.h"

namespace vultus::registration {

Points calmed_normals(const Mesh& scan, int rounds) {
  const Triangles& triangles = scan.topology->triangles();
  Points normals = vertex_normals(*scan.topology, scan.positions);
  for (int round = 0; round < rounds; ++round) {
    Points sum = normals;
    for (int t = 0; t < triangles.rows(); ++t) {
      const Eigen::RowVector3d mean =
          (normals.row(triangles(t, 0)) + normals.row(triangles(t, 1)) + normals.row(triangles(t, 2))) / 3.0;
      for (int k = 0; k < 3; ++k) sum.row(triangles(t, k)) += mean;
    }
    normals = sum.rowwise().normalized();
  }
  return normals;
}

}  // namespace vultus::registration
