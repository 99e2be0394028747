#include "apps/bench_registration/bench_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/bench_registration/statistics.h"
#include "register/register_options.h"

namespace vultus::apps::bench {
namespace {

using nlohmann::json;

json number(double value) { return std::isfinite(value) ? json(value) : json(); }

std::string cell(const json& value, const char* format) {
  return value.is_number() ? fmt::format(fmt::runtime(format), value.get<double>()) : "-";
}

/// Every method of the table and every one that registration has.
std::vector<std::string> all_methods() {
  std::vector<std::string> methods = registration::method_names();
  for (const char* name : {"default", "zhu", "sanchez"})
    if (std::ranges::count(methods, name) == 0) methods.emplace_back(name);
  return methods;
}

// Median distance to points that others placed; where there are none, of the landmarks that took part.
double landmark_residual(const CaseRow& row) {
  return row.landmarks.empty() ? row.quality.landmark_mean : quantile(row.landmarks, 0.5);
}

struct Pools {
  Pool surface, vertex, open_jaw, scan;
  std::vector<float> landmarks, placed, seconds, processor_seconds;
  double worst_median = NAN;
  double peak_bytes = 0.0;
  int cases = 0, failed = 0, flipped = 0, turned = 0, openings = 0, right_openings = 0;
  int verdicts[3] = {0, 0, 0};
};

bool jaw_is_open(const std::string& pose) { return pose == "jawOpen" || pose == "jaw_open"; }

Pools pooled(const std::vector<CaseRow>& rows, const std::string& method) {
  Pools pools;
  for (const CaseRow& row : rows) {
    if (row.method != method) continue;
    ++pools.cases;
    if (!row.error.empty()) {
      ++pools.failed;
      continue;
    }
    pools.placed.insert(pools.placed.end(), row.landmarks.begin(), row.landmarks.end());
    pools.seconds.push_back(static_cast<float>(row.seconds()));
    pools.processor_seconds.push_back(static_cast<float>(row.processor_seconds));
    pools.landmarks.push_back(static_cast<float>(row.quality.landmark_mean));
    pools.flipped += row.quality.flipped_triangles;
    pools.turned += row.turned_triangles;
    pools.peak_bytes = std::max(pools.peak_bytes, row.peak_bytes);
    for (const Opening& opening : row.openings) {
      ++pools.openings;
      pools.right_openings += opening.right();
    }
    ++pools.verdicts[static_cast<int>(row.quality.verdict)];
    pools.scan.add(row.scan);
    if (!row.distances) continue;
    pools.surface.add(row.distances->surface);
    pools.vertex.add(row.distances->vertex);
    if (jaw_is_open(row.pose)) pools.open_jaw.add(row.distances->vertex);
    const double median = quantile(row.distances->vertex, 0.5);
    if (!(median <= pools.worst_median)) pools.worst_median = median;
  }
  return pools;
}

json method_json(const std::vector<CaseRow>& rows, const std::string& method) {
  const Pools pools = pooled(rows, method);
  const bool truth = !pools.surface.empty();
  json result = {{"scan_mean_mm", number(truth ? pools.surface.mean() : pools.scan.mean())},
                 {"scan_p95_mm", number(truth ? pools.surface.quantile(0.95) : pools.scan.quantile(0.95))},
                 {"vertex_median_mm", number(pools.vertex.quantile(0.5))},
                 {"vertex_p95_mm", number(pools.vertex.quantile(0.95))},
                 {"seconds_per_scan", number(mean(pools.seconds))}};
  if (pools.cases == 0) return result;
  result["noisy_scan_mean_mm"] = number(pools.scan.mean());
  result["worst_vertex_median_mm"] = number(pools.worst_median);
  result["open_jaw_vertex_p95_mm"] = number(pools.open_jaw.quantile(0.95));
  result["landmark_residual_mm"] = number(quantile(pools.placed.empty() ? pools.landmarks : pools.placed, 0.5));
  result["processor_seconds_per_scan"] = number(mean(pools.processor_seconds));
  result["seconds_worst"] = number(quantile(pools.seconds, 1.0));
  result["cases"] = pools.cases;
  result["failed"] = pools.failed;
  result["flipped_triangles"] = pools.flipped;
  result["turned_triangles"] = truth ? json(pools.turned) : json();
  result["openings_right"] = pools.openings > 0 ? json(double(pools.right_openings) / pools.openings) : json();
  result["peak_memory_bytes"] = pools.peak_bytes;
  result["verdicts"] = {{"pass", pools.verdicts[0]}, {"warn", pools.verdicts[1]}, {"fail", pools.verdicts[2]}};
  return result;
}

}  // namespace

std::string row_line(const CaseRow& row) {
  const std::string head = fmt::format("{:8} {:8} {:9} {:14}", row.set, row.method, row.person, row.pose);
  if (!row.error.empty()) return head + " no result: " + row.error;
  std::string line = head;
  if (row.distances)
    line += fmt::format(" surface {:6.3f} {:6.3f}  vertex {:5.2f} {:6.2f}", mean(row.distances->surface),
                        quantile(row.distances->surface, 0.95), quantile(row.distances->vertex, 0.5),
                        quantile(row.distances->vertex, 0.95));
  line += fmt::format("  scan {:.3f}  landmarks {:.2f}  {:5.1f} s ({:.1f} cpu)  flips {}  {}", mean(row.scan),
                      landmark_residual(row), row.seconds(), row.processor_seconds, row.quality.flipped_triangles,
                      registration::verdict_name(row.quality.verdict));
  for (const Opening& opening : row.openings)
    if (!opening.right())
      line += fmt::format("; {} {:.1f} mm open instead of {:.1f}", opening.name, opening.found, opening.truly);
  for (const std::string& reason : row.quality.reasons) line += "; " + reason;
  return line;
}

std::vector<std::string> table_lines(const std::vector<SetResult>& results) {
  std::vector<std::string> lines = {fmt::format(
      "{:9} {:8} {:>6} {:>12} {:>11} {:>15} {:>13} {:>14} {:>13} {:>7} {:>6}", "set", "method", "cases", "surface mean",
      "surface p95", "vertex median", "vertex p95", "worst median", "open jaw p95", "s/scan", "flips")};
  const json sets = sets_json(results);
  for (const SetResult& result : results)
    for (const std::string& method : all_methods()) {
      const json& figures = sets.at(result.name).at(method);
      if (!figures.contains("cases")) continue;
      lines.push_back(fmt::format(
          "{:9} {:8} {:>6} {:>12} {:>11} {:>15} {:>13} {:>14} {:>13} {:>7} {:>6}", result.name, method,
          fmt::format("{}", figures["cases"].get<int>() - figures["failed"].get<int>()),
          cell(figures["scan_mean_mm"], "{:.3f}"), cell(figures["scan_p95_mm"], "{:.3f}"),
          cell(figures["vertex_median_mm"], "{:.2f}"), cell(figures["vertex_p95_mm"], "{:.2f}"),
          cell(figures["worst_vertex_median_mm"], "{:.2f}"), cell(figures["open_jaw_vertex_p95_mm"], "{:.2f}"),
          cell(figures["seconds_per_scan"], "{:.1f}"), figures["flipped_triangles"].get<int>()));
    }
  return lines;
}

json sets_json(const std::vector<SetResult>& results) {
  json sets = json::object();
  for (const std::string& name : set_names()) {
    const auto found = std::ranges::find(results, name, &SetResult::name);
    for (const std::string& method : all_methods())
      sets[name][method] = method_json(found == results.end() ? std::vector<CaseRow>{} : found->rows, method);
  }
  return sets;
}

json cases_json(const std::vector<SetResult>& results) {
  json cases = json::array();
  for (const SetResult& result : results)
    for (const CaseRow& row : result.rows) {
      json entry = {{"set", row.set}, {"method", row.method}, {"person", row.person}, {"pose", row.pose}};
      if (!row.error.empty()) {
        entry["error"] = row.error;
        cases.push_back(std::move(entry));
        continue;
      }
      entry["scan_triangles"] = row.scan_triangles;
      entry["clean_seconds"] = row.clean_seconds;
      entry["register_seconds"] = row.register_seconds;
      entry["processor_seconds"] = row.processor_seconds;
      entry["noisy_scan_mean_mm"] = number(mean(row.scan));
      if (const auto face = row.quality.sets.find("face"); face != row.quality.sets.end()) {
        entry["reported_scan_mean_mm"] = number(face->second.scan_to_mesh_mean);
        entry["reported_coverage"] = face->second.coverage;
      }
      entry["landmark_residual_mm"] = landmark_residual(row);
      entry["flipped_triangles"] = row.quality.flipped_triangles;
      if (row.distances) entry["turned_triangles"] = row.turned_triangles;
      entry["peak_memory_bytes"] = row.peak_bytes;
      for (const Opening& opening : row.openings)
        entry["openings"][opening.name] = {
            {"truly_mm", opening.truly}, {"found_mm", opening.found}, {"right", opening.right()}};
      entry["stretched_triangles"] = row.quality.stretched_triangles;
      entry["verdict"] = registration::verdict_name(row.quality.verdict);
      entry["reasons"] = row.quality.reasons;
      entry["decisions"] = row.decisions;
      if (row.distances) {
        entry["surface_mean_mm"] = number(mean(row.distances->surface));
        entry["surface_p95_mm"] = number(quantile(row.distances->surface, 0.95));
        entry["vertex_median_mm"] = number(quantile(row.distances->vertex, 0.5));
        entry["vertex_p95_mm"] = number(quantile(row.distances->vertex, 0.95));
      }
      if (row.leak) entry["truth_covered"] = row.leak->covered;
      if (row.leak)
        entry["leak"] = {{"to_vertices_mm", number(row.leak->to_vertices)},
                         {"by_chance_mm", number(row.leak->by_chance)},
                         {"ratio", number(row.leak->ratio())}};
      cases.push_back(std::move(entry));
    }
  return cases;
}

}  // namespace vultus::apps::bench
