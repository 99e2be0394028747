#pragma once

#include <filesystem>
#include <vector>

#include "core/mesh.h"

namespace vultus::apps::bench {

/// Writes a picture of the face from the front and from both sides, coloured by `distance` (one value a vertex, mm):
/// from blue (0) over green and yellow to red (`full_scale` and more); grey where the value is not finite or the vertex
/// is not among `shown`. Throws `OutputError`.
void write_heat_map(const std::filesystem::path& file, const Mesh& mesh, const Eigen::VectorXf& distance,
                    const std::vector<bool>& shown, double full_scale = 3.0);

}  // namespace vultus::apps::bench
