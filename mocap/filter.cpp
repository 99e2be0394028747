#include "mocap/filter.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/error.h"

namespace vultus::mocap {

namespace {

using Signal = std::vector<double>;

/// The signal continued by `pad` samples on both sides, reflected through its end points.
Signal padded(const Signal& x, std::size_t pad) {
  Signal y;
  y.reserve(x.size() + 2 * pad);
  for (std::size_t i = pad; i > 0; --i) y.push_back(2.0 * x.front() - x[std::min(i, x.size() - 1)]);
  y.insert(y.end(), x.begin(), x.end());
  for (std::size_t i = 1; i <= pad; ++i) y.push_back(2.0 * x.back() - x[x.size() - 1 - std::min(i, x.size() - 1)]);
  return y;
}

Signal convolved(const Signal& x, const Signal& half_kernel) {
  const std::size_t reach = half_kernel.size() - 1;
  const Signal wide = padded(x, reach);
  Signal y(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    double sum = half_kernel[0] * wide[i + reach];
    for (std::size_t k = 1; k <= reach; ++k) sum += half_kernel[k] * (wide[i + reach - k] + wide[i + reach + k]);
    y[i] = sum;
  }
  return y;
}

Signal gaussian_kernel(double sigma_frames) {
  const auto reach = static_cast<std::size_t>(std::ceil(3.0 * sigma_frames));
  Signal kernel(reach + 1);
  double sum = 0.0;
  for (std::size_t k = 0; k <= reach; ++k) {
    kernel[k] = std::exp(-0.5 * static_cast<double>(k * k) / (sigma_frames * sigma_frames));
    sum += k == 0 ? kernel[k] : 2.0 * kernel[k];
  }
  for (double& weight : kernel) weight /= sum;
  return kernel;
}

/// Second-order low pass by the bilinear transform.
struct Biquad {
  double b0, b1, b2, a1, a2;

  /// `cutoff` is where two runs together halve the power; one run must lose half of that there.
  static Biquad low_pass(double cutoff_hz, double rate_hz) {
    const double one_run = std::pow(std::sqrt(2.0) - 1.0, -0.25);  // ratio of the cutoffs of one and of two runs
    const double warped = one_run * std::tan(std::numbers::pi * cutoff_hz / rate_hz);
    const double norm = 1.0 / (1.0 + std::numbers::sqrt2 * warped + warped * warped);
    const double b = warped * warped * norm;
    return {b, 2.0 * b, b, 2.0 * (warped * warped - 1.0) * norm,
            (1.0 - std::numbers::sqrt2 * warped + warped * warped) * norm};
  }

  /// In place, from the steady state of a constant signal of the first value.
  void run(Signal& x) const {
    double z1 = x[0] * (1.0 - b0), z2 = x[0] * (b2 - a2);
    for (double& value : x) {
      const double in = value;
      value = b0 * in + z1;
      z1 = b1 * in - a1 * value + z2;
      z2 = b2 * in - a2 * value;
    }
  }
};

Signal butterworth(const Signal& x, double cutoff_hz, double rate_hz) {
  const Biquad filter = Biquad::low_pass(cutoff_hz, rate_hz);
  const auto pad = static_cast<std::size_t>(std::ceil(3.0 * rate_hz / cutoff_hz));
  Signal y = padded(x, pad);
  filter.run(y);
  std::reverse(y.begin(), y.end());
  filter.run(y);
  std::reverse(y.begin(), y.end());
  return {y.begin() + static_cast<std::ptrdiff_t>(pad), y.end() - static_cast<std::ptrdiff_t>(pad)};
}

Signal filtered(const Signal& x, const FilterOptions& options, double rate_hz) {
  switch (options.smoothing) {
    case Smoothing::three_frame:
      return convolved(x, {1.0 / 3.0, 1.0 / 3.0});
    case Smoothing::gaussian:
      return convolved(x, gaussian_kernel(options.sigma_seconds * rate_hz));
    case Smoothing::butterworth:
      return 2.0 * options.cutoff_hz >= rate_hz ? x : butterworth(x, options.cutoff_hz, rate_hz);
    case Smoothing::none:
      break;
  }
  return x;
}

void smooth_stretch(const FilterOptions& options, int marker, int first, int last, Take& take) {
  Signal x(static_cast<std::size_t>(last - first + 1));
  for (std::size_t c = 0; c < 3; ++c) {
    for (int f = first; f <= last; ++f)
      x[static_cast<std::size_t>(f - first)] = take.positions[3 * take.index(f, marker) + c];
    const Signal y = filtered(x, options, take.rate_hz);
    for (int f = first; f <= last; ++f) {
      take.positions[3 * take.index(f, marker) + c] = static_cast<float>(y[static_cast<std::size_t>(f - first)]);
    }
  }
}

}  // namespace

void FilterOptions::validate() const {
  if (!(cutoff_hz > 0.0)) throw UsageError("cutoff_hz must be positive");
  if (!(sigma_seconds > 0.0) || sigma_seconds > 10.0) throw UsageError("sigma_seconds must be in (0, 10]");
}

Take smoothed(Take take, const FilterOptions& options) {
  options.validate();
  if (options.smoothing == Smoothing::none) return take;
  tbb::parallel_for(0, take.markers(), [&](int m) {
    for (int f = 0; f < take.frames(); ++f) {
      if (!take.has(f, m)) continue;
      int last = f;
      while (last + 1 < take.frames() && take.has(last + 1, m)) ++last;
      if (last > f) smooth_stretch(options, m, f, last, take);
      f = last;
    }
  });
  return take;
}

}  // namespace vultus::mocap
