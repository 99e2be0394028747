#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace vultus::virtual_stage {

/// Smooth random field in space, about -1 … 1, with features of size 1: value noise on the integer lattice with a
/// quintic fade (Perlin 2002). The same everywhere for the same seed.
double solid_noise(const Eigen::Vector3d& p, std::uint32_t seed);

/// `octaves` of it, each half as large and half as strong.
double solid_noise(const Eigen::Vector3d& p, std::uint32_t seed, int octaves);

}  // namespace vultus::virtual_stage
