#include "retarget/errors.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "core/error.h"
#include "core/files.h"

namespace vultus::retarget {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// m_k(q) in the order of the basis's markers: markers × regions.
Eigen::MatrixXd ordered_weights(const MarkerBasis& basis, const MarkerWeights& weights) {
  Eigen::MatrixXd ordered(basis.markers(), weights.values.cols());
  for (int q = 0; q < basis.markers(); ++q) {
    const auto found = std::find(weights.labels.begin(), weights.labels.end(), basis.labels[q]);
    if (found == weights.labels.end()) throw InputError("marker " + basis.labels[q] + " has no region weights");
    ordered.row(q) = weights.values.row(found - weights.labels.begin());
  }
  return ordered;
}

void check_axes(const MarkerBasis& basis, const MarkerWeights& marker_weights, const Weights& weights) {
  if (weights.poses != basis.poses) throw InputError("reconstruction: weights and basis name other poses");
  if (weights.regions != marker_weights.regions) throw InputError("reconstruction: weights name other regions");
}

Eigen::VectorXd reconstruct_frame(const MarkerBasis& basis, const Eigen::MatrixXd& counts, const Weights& weights,
                                  int frame) {
  const int regions = static_cast<int>(weights.regions.size());
  Eigen::MatrixXd by_region(basis.columns.cols(), regions);
  for (int k = 0; k < regions; ++k) {
    const auto row = weights.at(frame, k);
    by_region.col(k) = Eigen::Map<const Eigen::VectorXf>(row.data(), static_cast<Eigen::Index>(row.size())).cast<double>();
  }
  const Eigen::MatrixXd by_marker = by_region * counts.transpose();  // poses × markers
  Eigen::VectorXd positions(basis.columns.rows());
  for (int q = 0; q < basis.markers(); ++q) {
    positions.segment<3>(3 * q) = basis.columns.middleRows<3>(3 * q) * by_marker.col(q);
  }
  return positions;
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells;
  std::size_t start = 0;
  for (;;) {
    const std::size_t comma = line.find(',', start);
    cells.push_back(line.substr(start, comma - start));
    if (comma == std::string::npos) return cells;
    start = comma + 1;
  }
}

double number(const std::string& cell, const std::filesystem::path& file, int line) {
  double value = 0.0;
  const char* end = cell.data() + cell.size();
  const auto parsed = std::from_chars(cell.data(), end, value);
  if (parsed.ec != std::errc() || parsed.ptr != end) {
    throw InputError(file, "line " + std::to_string(line), "\"" + cell + "\" is not a number");
  }
  return value;
}

/// Mean of the values that are not NaN.
class Mean {
 public:
  void add(double value) {
    if (std::isnan(value)) return;
    sum_ += value;
    ++count_;
  }
  double value() const { return count_ > 0 ? sum_ / count_ : kNone; }

 private:
  double sum_ = 0.0;
  long count_ = 0;
};

}  // namespace

Eigen::VectorXd reconstruct(const MarkerBasis& basis, const MarkerWeights& marker_weights, const Weights& weights,
                            int frame) {
  check_axes(basis, marker_weights, weights);
  return reconstruct_frame(basis, ordered_weights(basis, marker_weights), weights, frame);
}

MarkerErrors marker_errors(const mocap::Take& take, const MarkerBasis& basis, const MarkerWeights& marker_weights,
                           const Weights& weights) {
  check_axes(basis, marker_weights, weights);
  if (weights.frames() != take.frames()) throw InputError("reconstruction: weights and take differ in frames");
  const Eigen::MatrixXd counts = ordered_weights(basis, marker_weights);
  std::vector<int> source;
  for (const std::string& label : basis.labels) source.push_back(take.find(label));
  MarkerErrors errors{take.rate_hz, basis.labels, {}};
  errors.values.assign(static_cast<std::size_t>(take.frames()) * source.size(), static_cast<float>(kNone));
  tbb::parallel_for(0, take.frames(), [&](int frame) {
    const Eigen::VectorXd positions = reconstruct_frame(basis, counts, weights, frame);
    for (std::size_t q = 0; q < source.size(); ++q) {
      if (source[q] < 0 || !take.has(frame, source[q])) continue;
      const Eigen::Vector3d reconstructed = positions.segment<3>(3 * static_cast<Eigen::Index>(q));
      errors.values[frame * source.size() + q] =
          static_cast<float>((take.at(frame, source[q]) - reconstructed).norm());
    }
  });
  return errors;
}

std::vector<double> mean_by_marker(const MarkerErrors& errors) {
  std::vector<Mean> means(errors.labels.size());
  for (std::size_t i = 0; i < errors.values.size(); ++i) means[i % means.size()].add(errors.values[i]);
  std::vector<double> result;
  for (const Mean& mean : means) result.push_back(mean.value());
  return result;
}

std::vector<double> mean_by_frame(const MarkerErrors& errors) {
  std::vector<double> result;
  for (int frame = 0; frame < errors.frames(); ++frame) {
    Mean mean;
    for (std::size_t q = 0; q < errors.labels.size(); ++q) mean.add(errors.at(frame, static_cast<int>(q)));
    result.push_back(mean.value());
  }
  return result;
}

ErrorSummary summarize(const MarkerErrors& errors, std::string name, int regions) {
  ErrorSummary summary{std::move(name), regions, kNone, kNone, kNone};
  Mean mean;
  for (double marker : mean_by_marker(errors)) {
    if (std::isnan(marker)) continue;
    mean.add(marker);
    summary.max = std::isnan(summary.max) ? marker : std::max(summary.max, marker);
    summary.min = std::isnan(summary.min) ? marker : std::min(summary.min, marker);
  }
  summary.mean = mean.value();
  return summary;
}

void write_errors(const std::filesystem::path& file, const MarkerErrors& errors) {
  std::string text = "frame,time_s";
  for (const std::string& label : errors.labels) text += "," + label;
  text += "\n";
  for (int frame = 0; frame < errors.frames(); ++frame) {
    text += fmt::format("{},{:.6f}", frame, errors.rate_hz > 0.0 ? frame / errors.rate_hz : 0.0);
    for (std::size_t q = 0; q < errors.labels.size(); ++q) {
      const float value = errors.at(frame, static_cast<int>(q));
      text += std::isnan(value) ? std::string(",") : fmt::format(",{:.4f}", value);
    }
    text += "\n";
  }
  write_file(file, text);
}

MarkerErrors read_errors(const std::filesystem::path& file) {
  const std::string text = read_file(file);
  MarkerErrors errors;
  std::size_t start = 0;
  double second_time = 0.0;
  for (int line = 1; start < text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    const std::vector<std::string> cells = split(text.substr(start, end - start));
    start = end + 1;
    if (line == 1) {
      if (cells.size() < 3 || cells[0] != "frame" || cells[1] != "time_s") {
        throw InputError(file, "line 1", "must begin with \"frame,time_s,\" and name the markers");
      }
      errors.labels.assign(cells.begin() + 2, cells.end());
      continue;
    }
    if (cells.size() != errors.labels.size() + 2) {
      throw InputError(file, "line " + std::to_string(line),
                       fmt::format("{} cells where {} are needed", cells.size(), errors.labels.size() + 2));
    }
    if (line == 3) second_time = number(cells[1], file, line);
    for (std::size_t i = 2; i < cells.size(); ++i) {
      errors.values.push_back(static_cast<float>(cells[i].empty() ? kNone : number(cells[i], file, line)));
    }
  }
  if (errors.labels.empty()) throw InputError(file, "is empty; errors.csv begins with \"frame,time_s,\"");
  errors.rate_hz = second_time > 0.0 ? 1.0 / second_time : 0.0;
  return errors;
}

}  // namespace vultus::retarget
