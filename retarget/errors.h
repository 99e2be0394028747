#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mocap/take.h"
#include "retarget/marker_basis.h"
#include "retarget/marker_weights.h"
#include "retarget/weights.h"

namespace vultus::retarget {

/// Distance of every captured marker to its reconstruction, in the space of the basis.
struct MarkerErrors {
  double rate_hz = 0.0;
  std::vector<std::string> labels;
  std::vector<float> values;  ///< frames × markers, mm; NaN where the take has no sample

  int frames() const { return labels.empty() ? 0 : static_cast<int>(values.size() / labels.size()); }
  float at(int frame, int marker) const { return values[static_cast<std::size_t>(frame) * labels.size() + marker]; }
};

/// Where the weights put the markers: marker q is Σ_k m_k(q) S_q w_k, Liu eq. 3 with the markers' own region weights for
/// the masks. 3·markers long, mm.
Eigen::VectorXd reconstruct(const MarkerBasis& basis, const MarkerWeights& marker_weights, const Weights& weights,
                            int frame);

/// Errors of a whole take. `take` is in the basis's space.
MarkerErrors marker_errors(const mocap::Take& take, const MarkerBasis& basis, const MarkerWeights& marker_weights,
                           const Weights& weights);

/// A row of Liu et al. 2011 table 1: the mean error of each marker over the performance, then its largest, smallest and
/// mean value over the markers, mm. NaN for a take without samples.
struct ErrorSummary {
  std::string name;  ///< "global" or "n regions"
  int regions = 1;
  double max = 0.0, min = 0.0, mean = 0.0;
};
ErrorSummary summarize(const MarkerErrors& errors, std::string name, int regions);
std::vector<double> mean_by_marker(const MarkerErrors& errors);  ///< mm, NaN for a marker never seen
std::vector<double> mean_by_frame(const MarkerErrors& errors);   ///< mm, NaN for a frame without samples

/// errors.csv: "frame,time_s,<label>,…", one row a frame, mm with 4 decimals, empty where there is no sample.
void write_errors(const std::filesystem::path& file, const MarkerErrors& errors);
/// Throws `InputError` naming the line.
MarkerErrors read_errors(const std::filesystem::path& file);

}  // namespace vultus::retarget
