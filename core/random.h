#pragma once

#include <cstdint>

namespace vultus {

/// Small counter-friendly generator (PCG-XSH-RR 64/32, O'Neill 2014): the same numbers on every machine and thread.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0);
  std::uint32_t next();
  double uniform();                            ///< [0, 1)
  double uniform(double low, double high);     ///< [low, high)
  double normal();                             ///< mean 0, deviation 1 (Box–Muller)
  int below(int n);                            ///< 0 … n-1

 private:
  std::uint64_t state_, increment_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace vultus
