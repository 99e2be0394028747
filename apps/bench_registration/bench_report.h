#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/bench_registration/registration_bench.h"

namespace vultus::apps::bench {

/// One line of text a case, and the table of all sets and methods at the end.
std::string row_line(const CaseRow& row);
std::vector<std::string> table_lines(const std::vector<SetResult>& results);

/// {SET: {METHOD: {scan_mean_mm, scan_p95_mm, vertex_median_mm, vertex_p95_mm, seconds_per_scan, …}}}: every set and
/// method is there, null where it was not run or does not apply. Pooled as `Pool` says.
/// - `scan_mean_mm`, `scan_p95_mm`: of the clean surface to the mesh where the truth is known, else of the trusted part
///   of the scan itself (`scan_distances`), whose mean all have besides as `noisy_scan_mean_mm`.
/// - `vertex_…`: of the measured vertices to where they should be; the open jaw's also by itself.
/// - `landmark_residual_mm`: median distance to the points that others placed on a real scan; without any, median over
///   the scans of the residual of the landmarks that took part.
/// - `seconds_per_scan`: mean over the scans; cleaning and registering, without reading.
/// Scans without a result are counted in `failed` and missing from every other figure.
nlohmann::json sets_json(const std::vector<SetResult>& results);
/// Everything measured on each case.
nlohmann::json cases_json(const std::vector<SetResult>& results);

}  // namespace vultus::apps::bench
