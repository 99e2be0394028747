#include "apps/review_takes.h"

#include <algorithm>
#include <cmath>

#include "apps/review_cleaning.h"
#include "apps/review_encoding.h"
#include "core/statistics.h"

namespace vultus::apps {
namespace {

constexpr std::size_t kMostWeights = 2'500'000;  // 16-bit values: 6.7 MB of base64
constexpr std::size_t kMostErrors = 1'200'000;
constexpr double kWeightStep = 1.0 / 65534.0;
constexpr double kErrorStep = 0.001;  // mm

/// Share of the frames in which cameras saw a marker; without a record of that, in which it has an error.
double seen_share(const ReviewTake& take, const std::string& label, std::size_t with_error) {
  if (take.samples) {
    const auto& labels = take.samples->labels;
    const auto at = std::find(labels.begin(), labels.end(), label);
    if (at != labels.end()) return 1.0 - take.samples->missing[static_cast<std::size_t>(at - labels.begin())];
  }
  return static_cast<double>(with_error) / std::max(1, take.errors->frames());
}

nlohmann::json marker_rows(const ReviewTake& take) {
  const retarget::MarkerErrors& errors = *take.errors;
  const std::vector<double> means = retarget::mean_by_marker(errors);
  const std::vector<double> global = take.global_errors && take.global_errors->labels == errors.labels
                                         ? retarget::mean_by_marker(*take.global_errors)
                                         : std::vector<double>(means.size(), std::nan(""));
  nlohmann::json rows = nlohmann::json::array();
  for (std::size_t q = 0; q < errors.labels.size(); ++q) {
    std::vector<double> seen;
    for (int f = 0; f < errors.frames(); ++f) {
      const float value = errors.at(f, static_cast<int>(q));
      if (!std::isnan(value)) seen.push_back(value);
    }
    rows.push_back({{"label", errors.labels[q]},
                    {"mean", finite_or_null(means[q])},
                    {"p95", finite_or_null(quantile(seen, 0.95))},
                    {"max", finite_or_null(quantile(seen, 1.0))},
                    {"global", finite_or_null(global[q])},
                    {"present", finite_or_null(seen_share(take, errors.labels[q], seen.size()))}});
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
  for (const char* key : {"space", "solve"}) {
    if (take.report.contains(key)) json[key] = take.report[key];
  }
  json["decisions"] = decisions_json(take);
  json.update(cleaning_json(take));
  return json;
}

}  // namespace vultus::apps
