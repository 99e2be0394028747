#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace vultus::render {

/// Owen-scrambled Sobol points in [0, 1)², one independently shuffled and scrambled copy for each pair of dimensions
/// (Burley 2020, "Practical Hash-based Owen Scrambling"). Numbers depend on seed, pixel, sample and the count of draws
/// only, never on threads.
class Sampler {
 public:
  /// `pixel` is any number that differs between pixels.
  Sampler(std::uint64_t seed, std::uint64_t pixel);
  void start(std::uint32_t sample_index);  ///< first dimension of the given sample
  Eigen::Vector2f next_2d();
  float next_1d() { return next_2d().x(); }

 private:
  std::uint32_t pixel_seed_, reversed_index_ = 0, dimension_ = 0;
};

}  // namespace vultus::render
