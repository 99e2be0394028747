#include "apps/review_takes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/review_encoding.h"

namespace vultus::apps {
namespace {

constexpr std::size_t kMostWeights = 2'500'000;  // 16-bit values: 6.7 MB of base64
constexpr std::size_t kMostErrors = 1'200'000;
constexpr double kWeightStep = 1.0 / 65534.0;
constexpr double kErrorStep = 0.001;  // mm
constexpr std::size_t kMostPlaces = 1'500'000;
constexpr double kPlaceStep = 0.005;  // mm: 65534 of them are a third of a metre

nlohmann::json finite_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(std::round(value * 1e4) / 1e4) : nlohmann::json(nullptr);
}

/// Every n-th row of `width` values such that at most `most` remain.
nlohmann::json rows_json(const std::vector<float>& values, std::size_t width, std::size_t most, double step) {
  const std::size_t stride = std::max<std::size_t>(1, (values.size() + most - 1) / most);
  std::vector<float> kept;
  for (std::size_t start = 0; start + width <= values.size(); start += stride * width) {
    kept.insert(kept.end(), values.begin() + static_cast<std::ptrdiff_t>(start),
                values.begin() + static_cast<std::ptrdiff_t>(start + width));
  }
  return {{"stride", stride},
          {"width", width},
          {"step", step},
          {"data", base64(std::span<const std::uint16_t>(quantized(kept, step)))}};
}

double quantile(std::vector<float> values, double share) {
  if (values.empty()) return std::nan("");
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

nlohmann::json marker_rows(const ReviewTake& take) {
  const retarget::MarkerErrors& errors = *take.errors;
  const std::vector<double> means = retarget::mean_by_marker(errors);
  const std::vector<double> global = take.global_errors && take.global_errors->labels == errors.labels
                                         ? retarget::mean_by_marker(*take.global_errors)
                                         : std::vector<double>(means.size(), std::nan(""));
  nlohmann::json rows = nlohmann::json::array();
  for (std::size_t q = 0; q < errors.labels.size(); ++q) {
    std::vector<float> seen;
    for (int f = 0; f < errors.frames(); ++f) {
      const float value = errors.at(f, static_cast<int>(q));
      if (!std::isnan(value)) seen.push_back(value);
    }
    const double frames = errors.frames() > 0 ? errors.frames() : 1;
    rows.push_back({{"label", errors.labels[q]},
                    {"mean", finite_or_null(means[q])},
                    {"p95", finite_or_null(quantile(seen, 0.95))},
                    {"max", finite_or_null(quantile(seen, 1.0))},
                    {"global", finite_or_null(global[q])},
                    {"present", finite_or_null(static_cast<double>(seen.size()) / frames)}});
  }
  return rows;
}

nlohmann::json table_of(const ReviewTake& take) {
  if (take.report.contains("table") && take.report["table"].is_array()) return take.report["table"];
  nlohmann::json table = nlohmann::json::array();
  const auto add = [&](const retarget::MarkerErrors& errors, const std::string& name, int regions) {
    const auto row = retarget::summarize(errors, name, regions);
    table.push_back({{"regions", row.regions},
                     {"name", row.name},
                     {"max_mm", finite_or_null(row.max)},
                     {"min_mm", finite_or_null(row.min)},
                     {"mean_mm", finite_or_null(row.mean)}});
  };
  if (take.global_errors) add(*take.global_errors, "global", 1);
  if (take.errors && take.weights) {
    const int regions = static_cast<int>(take.weights->regions.size());
    add(*take.errors, regions == 1 ? "global" : std::to_string(regions) + " regions", regions);
  }
  return table;
}

nlohmann::json means_json(const retarget::MarkerErrors& errors) {
  std::vector<float> means;
  for (double mean : retarget::mean_by_frame(errors)) means.push_back(static_cast<float>(mean));
  return rows_json(means, 1, kMostErrors, kErrorStep);
}

nlohmann::json gaps_json(const mocap::CleanReport& samples) {
  nlohmann::json rows = nlohmann::json::array();
  for (const mocap::Gap& gap : samples.gaps) {
    rows.push_back({{"marker", samples.labels[gap.marker]},
                    {"first", gap.first},
                    {"last", gap.last},
                    {"method", mocap::name_of(gap.method)},
                    {"expected_error_mm", finite_or_null(gap.expected_error)}});
  }
  return rows;
}

nlohmann::json repairs_json(const mocap::CleanReport& samples) {
  nlohmann::json rows = nlohmann::json::array();
  for (const mocap::RepeatNote& repeat : samples.repeats) {
    const int frames = repeat.last - repeat.first + 1;
    const std::string what = repeat.kind == mocap::Repeat::Kind::doubled ? "{} frames put in twice taken out"
                             : repeat.kind == mocap::Repeat::Kind::held  ? "{} frames held for lost ones filled"
                                                                         : "held in place for {} frames, filled";
    rows.push_back(
        {{"marker", repeat.marker}, {"frame", repeat.first}, {"what", fmt::format(fmt::runtime(what), frames)}});
  }
  for (const mocap::Spike& spike : samples.spikes) {
    rows.push_back({{"marker", samples.labels[spike.marker]},
                    {"frame", spike.first},
                    {"what", fmt::format("spike of {:.1f} mm removed", spike.size)}});
  }
  return rows;
}

nlohmann::json stabilization_json(const mocap::CleanReport& samples) {
  nlohmann::json residuals = nlohmann::json::array();
  for (double value : samples.head_residuals) residuals.push_back(finite_or_null(value));
  return {{"method", samples.head_method}, {"rms", finite_or_null(samples.head_rms)}, {"rms_mm", residuals}};
}

/// Least coordinate of each marker and axis over both takes, mm; a value below it would not be stored.
std::vector<float> least_places(const mocap::Take& measured, const mocap::Take& clean) {
  std::vector<float> least(3 * clean.labels.size(), 0.0F);
  std::vector<char> known(least.size(), 0);
  for (const mocap::Take* take : {&measured, &clean}) {
    for (std::size_t i = 0; i < take->positions.size(); ++i) {
      const int marker = clean.find(take->labels[i / 3 % take->labels.size()]);
      if (marker < 0 || take->present[i / 3] == 0) continue;
      const std::size_t k = 3 * static_cast<std::size_t>(marker) + i % 3;
      least[k] = known[k] ? std::min(least[k], take->positions[i]) : take->positions[i];
      known[k] = 1;
    }
  }
  return least;
}

/// frames × (markers of `clean` × 3), above `least`; NaN where missing.
std::vector<float> places_of(const mocap::Take& take, const mocap::Take& clean, const std::vector<float>& least) {
  std::vector<int> column;
  for (const std::string& label : clean.labels) column.push_back(take.find(label));
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(take.frames()) * least.size());
  for (int f = 0; f < take.frames(); ++f) {
    for (std::size_t k = 0; k < least.size(); ++k) {
      const int m = column[k / 3];
      const bool here = m >= 0 && take.has(f, m);
      values.push_back(here ? take.positions[3 * take.index(f, m) + k % 3] - least[k]
                            : std::numeric_limits<float>::quiet_NaN());
    }
  }
  return values;
}

nlohmann::json curves_json(const mocap::Take& measured, const mocap::Take& clean) {
  const std::vector<float> least = least_places(measured, clean);
  const std::size_t width = least.size();
  return {{"labels", clean.labels},
          {"least", least},
          {"measured", rows_json(places_of(measured, clean, least), width, kMostPlaces, kPlaceStep)},
          {"clean", rows_json(places_of(clean, clean, least), width, kMostPlaces, kPlaceStep)}};
}

nlohmann::json decisions_json(const ReviewTake& take) {
  if (take.report.contains("decisions") && take.report["decisions"].is_array()) return take.report["decisions"];
  return take.samples ? nlohmann::json(take.samples->decisions) : nlohmann::json::array();
}

}  // namespace

nlohmann::json take_json(const ReviewTake& take) {
  nlohmann::json json = {{"name", take.name}, {"rate_hz", take.rate_hz()}, {"frames", take.frames()}};
  if (take.weights) {
    json["regions"] = take.weights->regions;
    json["poses"] = take.weights->poses;
    json["weights"] = rows_json(take.weights->values, take.weights->regions.size() * take.weights->poses.size(),
                                kMostWeights, kWeightStep);
  }
  if (take.errors) {
    json["errors"] = rows_json(take.errors->values, take.errors->labels.size(), kMostErrors, kErrorStep);
    json["markers"] = marker_rows(take);
  }
  if (take.global_errors) json["global_means"] = means_json(*take.global_errors);
  json["table"] = table_of(take);
  for (const char* key : {"space", "warnings", "solve"}) {
    if (take.report.contains(key)) json[key] = take.report[key];
  }
  json["decisions"] = decisions_json(take);
  if (take.samples) {
    json["gaps"] = gaps_json(*take.samples);
    json["repairs"] = repairs_json(*take.samples);
    json["stabilization"] = stabilization_json(*take.samples);
  }
  if (take.measured && take.clean) json["curves"] = curves_json(*take.measured, *take.clean);
  return json;
}

}  // namespace vultus::apps
