#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace vultus::virtual_stage {

/// A person's colours, linear RGB reflectance.
struct Complexion {
  Eigen::Vector3f skin, flush;  ///< bare skin, and skin with the most blood (cheeks, nose, ears)
  Eigen::Vector3f lips, hair, iris;
  double freckles = 0.0;   ///< 0 … 1
  std::uint32_t seed = 0;  ///< of every pattern
};

/// Skin from light to dark by melanin, with hair and irises that go with it; the same for the same seed.
Complexion random_complexion(std::uint64_t seed);

}  // namespace vultus::virtual_stage
