#pragma once

#include <pmmintrin.h>
#include <xmmintrin.h>

namespace vultus {

/// While it lives, this thread's denormal floats count as zero: ray tracing slows down by orders of magnitude on them.
/// The caller's floating-point mode is put back afterwards.
class FlushDenormals {
 public:
  FlushDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | _MM_FLUSH_ZERO_ON | _MM_DENORMALS_ZERO_ON); }
  ~FlushDenormals() { _mm_setcsr(saved_); }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  unsigned saved_;
};

}  // namespace vultus
