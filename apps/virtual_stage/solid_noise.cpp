#include "apps/virtual_stage/solid_noise.h"

#include <cmath>

namespace vultus::virtual_stage {
namespace {

double lattice(int x, int y, int z, std::uint32_t seed) {
  std::uint32_t h = seed * 0x9E3779B9u + static_cast<std::uint32_t>(x) * 0x85EBCA6Bu +
                    static_cast<std::uint32_t>(y) * 0xC2B2AE35u + static_cast<std::uint32_t>(z) * 0x27D4EB2Fu;
  h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
  h = (h ^ (h >> 12)) * 0x297A2D39u;
  return (h ^ (h >> 15)) * (2.0 / 4294967295.0) - 1.0;
}

double fade(double t) { return t * t * t * (t * (6.0 * t - 15.0) + 10.0); }

}  // namespace

double solid_noise(const Eigen::Vector3d& p, std::uint32_t seed) {
  const Eigen::Vector3d cell = p.array().floor();
  const int x = static_cast<int>(cell.x()), y = static_cast<int>(cell.y()), z = static_cast<int>(cell.z());
  const Eigen::Vector3d f = (p - cell).unaryExpr(&fade);
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const int i = corner & 1, j = (corner >> 1) & 1, k = corner >> 2;
    const double weight = (i ? f.x() : 1 - f.x()) * (j ? f.y() : 1 - f.y()) * (k ? f.z() : 1 - f.z());
    sum += weight * lattice(x + i, y + j, z + k, seed);
  }
  return sum;
}

double solid_noise(const Eigen::Vector3d& p, std::uint32_t seed, int octaves) {
  double sum = 0.0, scale = 1.0;
  for (int o = 0; o < octaves; ++o, scale *= 2.0)
    sum += solid_noise(p * scale, seed + static_cast<std::uint32_t>(o)) / scale;
  return sum;
}

}  // namespace vultus::virtual_stage
