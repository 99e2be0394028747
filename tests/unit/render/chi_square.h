#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace vultus::render {

/// Probability of a χ² statistic at least this large under the hypothesis (Wilson and Hilferty 1931).
inline double chi_square_p_value(double statistic, int degrees) {
  const double k = degrees, scale = 2.0 / (9.0 * k);
  const double z = (std::cbrt(statistic / k) - (1.0 - scale)) / std::sqrt(scale);
  return 0.5 * std::erfc(z / std::numbers::sqrt2);
}

/// Directions binned by cosθ and φ about z, against a density per steradian integrated over each bin. Bins that expect
/// fewer than 5 counts are pooled. Draws that `draw` reports as failed (zero vectors) count in no bin: the density
/// should then integrate to less than one. Each bin's integral takes `substeps`² points.
inline double direction_test(const std::function<Eigen::Vector3f()>& draw,
                             const std::function<double(const Eigen::Vector3f&)>& pdf, int draws, int substeps = 24) {
  constexpr int rows = 20, columns = 20;
  std::vector<double> expected(rows * columns, 0.0), observed(rows * columns, 0.0);
  const double cell = 4.0 * std::numbers::pi / (rows * columns * substeps * substeps);
  for (int r = 0; r < rows * substeps; ++r)
    for (int c = 0; c < columns * substeps; ++c) {
      const double z = -1.0 + 2.0 * (r + 0.5) / (rows * substeps), s = std::sqrt(1.0 - z * z);
      const double phi = 2.0 * std::numbers::pi * (c + 0.5) / (columns * substeps);
      const Eigen::Vector3d w(s * std::cos(phi), s * std::sin(phi), z);
      expected[(r / substeps) * columns + c / substeps] += pdf(w.cast<float>()) * cell * draws;
    }
  for (int i = 0; i < draws; ++i) {
    const Eigen::Vector3d w = draw().cast<double>();
    if (w.squaredNorm() < 0.5) continue;
    double phi = std::atan2(w.y(), w.x());
    if (phi < 0) phi += 2.0 * std::numbers::pi;
    const int r = std::min(rows - 1, static_cast<int>(0.5 * (w.z() + 1.0) * rows));
    const int c = std::min(columns - 1, static_cast<int>(phi / (2.0 * std::numbers::pi) * columns));
    observed[r * columns + c] += 1.0;
  }
  double statistic = 0.0, pooled_expected = 0.0, pooled_observed = 0.0;
  int bins = 0;
  for (int i = 0; i < rows * columns; ++i) {
    if (expected[i] < 5.0) {
      pooled_expected += expected[i];
      pooled_observed += observed[i];
      continue;
    }
    statistic += (observed[i] - expected[i]) * (observed[i] - expected[i]) / expected[i];
    ++bins;
  }
  if (pooled_expected < 0.5 && pooled_observed > 10) return 0.0;  // draws where the density says none can fall
  if (pooled_expected >= 5.0) {
    statistic += (pooled_observed - pooled_expected) * (pooled_observed - pooled_expected) / pooled_expected;
    ++bins;
  }
  return chi_square_p_value(statistic, bins - 1);
}

}  // namespace vultus::render
