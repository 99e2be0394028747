#include "render/sampler.h"

#include <algorithm>

namespace vultus::render {
namespace {

/// Finalizer of MurmurHash3 (Appleby 2011).
std::uint32_t mixed(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x85ebca6bu;
  x ^= x >> 13;
  x *= 0xc2b2ae35u;
  return x ^ (x >> 16);
}

std::uint32_t combined(std::uint32_t seed, std::uint32_t value) {
  return seed ^ (mixed(value) + 0x9e3779b9u + (seed << 6) + (seed >> 2));
}

std::uint32_t reversed_bits(std::uint32_t x) {
  x = __builtin_bswap32(x);
  x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
  x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
  return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
}

/// Owen scrambling of a bit-reversed number: each bit is flipped by a hash of the bits below it (Laine and Karras
/// 2011, with Vegdahl's 2021 constants).
std::uint32_t owen_scrambled_reversed(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

/// Second Sobol dimension of an index given bit-reversed (the first is the reversed index itself): its matrix is
/// Pascal's triangle modulo 2, applied by doubling (Ahmed 2024).
std::uint32_t sobol_1_of_reversed(std::uint32_t x) {
  x ^= x << 16;
  x ^= (x & 0x00ff00ffu) << 8;
  x ^= (x & 0x0f0f0f0fu) << 4;
  x ^= (x & 0x33333333u) << 2;
  return x ^ ((x & 0x55555555u) << 1);
}

float unit_float(std::uint32_t x) { return static_cast<float>(x >> 8) * 0x1p-24f; }

}  // namespace

Sampler::Sampler(std::uint64_t seed, std::uint64_t pixel) {
  pixel_seed_ = mixed(static_cast<std::uint32_t>(seed) ^ 0x6a09e667u);
  pixel_seed_ = combined(pixel_seed_, static_cast<std::uint32_t>(seed >> 32));
  pixel_seed_ = combined(pixel_seed_, static_cast<std::uint32_t>(pixel));
  pixel_seed_ = mixed(combined(pixel_seed_, static_cast<std::uint32_t>(pixel >> 32)));
}

void Sampler::start(std::uint32_t sample_index) {
  reversed_index_ = reversed_bits(sample_index);
  dimension_ = 0;
}

Eigen::Vector2f Sampler::next_2d() {
  const std::uint32_t seed = mixed(combined(pixel_seed_, dimension_++));
  const std::uint32_t reversed = owen_scrambled_reversed(reversed_index_, seed);  // shuffles the order of points
  const std::uint32_t x = owen_scrambled_reversed(reversed_bits(reversed), mixed(seed ^ 0xa511e9b3u));
  const std::uint32_t y =
      owen_scrambled_reversed(reversed_bits(sobol_1_of_reversed(reversed)), mixed(seed ^ 0x63d83595u));
  return {unit_float(reversed_bits(x)), unit_float(reversed_bits(y))};
}

}  // namespace vultus::render
