#pragma once

#include <vector>

#include "apps/virtual_stage/face_features.h"

namespace vultus::virtual_stage {

/// Displacement of some vertices by one channel at strength 1.
struct MuscleField {
  std::vector<int> vertices;
  Points displacement;  ///< a row for each of `vertices`, mm
};

/// What every muscle channel does to this identity, in channel order (2·muscle_count); lids are left alone where
/// `hold` (vertex_count, see `lid_hold`) is 1.
std::vector<MuscleField> muscle_fields(const FaceFeatures& face, const Eigen::VectorXd& hold);

}  // namespace vultus::virtual_stage
