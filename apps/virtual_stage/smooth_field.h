#pragma once

#include <utility>
#include <vector>

#include "core/mesh.h"

namespace vultus::virtual_stage {

/// Smoothest scalar field on a mesh through given (vertex, value) pairs: minimizes ∫(Δf)² with the cotangent Laplacian
/// (biharmonic interpolation, Botsch and Kobbelt 2004). Connected parts without a given value are 0.
Eigen::VectorXd smooth_field(const Topology& topology, const Points& positions,
                             const std::vector<std::pair<int, double>>& given);

}  // namespace vultus::virtual_stage
