#pragma once

#include <Eigen/SparseCore>
#include <utility>
#include <vector>

#include "core/mesh.h"

namespace vultus::virtual_stage {

/// Smoothest scalar fields on a mesh through given values: minimizes ∫(Δf)² with the cotangent Laplacian (biharmonic
/// interpolation, Botsch and Kobbelt 2004).
class SmoothFields {
 public:
  SmoothFields(const Topology& topology, const Points& positions);

  /// One value a vertex, equal to `given` (vertex, value) there. Connected parts without a given value are 0. Throws
  /// `InputError` for a mesh of degenerate triangles.
  Eigen::VectorXd through(const std::vector<std::pair<int, double>>& given) const;

 private:
  Eigen::SparseMatrix<double> energy_;
};

}  // namespace vultus::virtual_stage
