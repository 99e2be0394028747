#include "apps/session_solve.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/files.h"
#include "retarget/errors.h"
#include "rig/region_masks.h"

namespace vultus::apps {
namespace {

using nlohmann::json;

struct Solved {
  retarget::SolveResult result;
  retarget::MarkerErrors errors;
  double frames_per_second = 0.0;
};

Solved solved(const mocap::Take& take, const SolveSetup& setup, const retarget::MarkerWeights& weights,
              Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  Solved solution;
  solution.result = retarget::solve_take(take, setup.basis.basis, weights, setup.options, progress);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  solution.frames_per_second = take.frames() / std::max(seconds, 1e-9);
  solution.errors = retarget::marker_errors(take, setup.basis.basis, weights, solution.result.weights);
  return solution;
}

json row_json(const retarget::ErrorSummary& row) {
  const auto number = [](double value) { return std::isfinite(value) ? json(value) : json(); };
  return {{"regions", row.regions},
          {"name", row.name},
          {"max_mm", number(row.max)},
          {"min_mm", number(row.min)},
          {"mean_mm", number(row.mean)}};
}

json residuals_json(const std::vector<double>& residuals) {
  json list = json::array();
  for (const double value : residuals)
    list.push_back(std::isfinite(value) ? json(std::round(value * 1e4) / 1e4) : json());
  return list;
}

json report_of(const SessionTake& take, const SolveSetup& setup, const Solved& global, const Solved& chosen,
               const json& table) {
  json decisions = setup.decisions, warnings = setup.warnings;
  for (const std::string& line : take.report.decisions) decisions.push_back(line);
  for (const std::string& line : take.report.warnings) warnings.push_back(line);
  for (const std::string& line : chosen.result.notes) decisions.push_back(line);
  for (const std::string& line : global.result.notes) {
    if (std::find(chosen.result.notes.begin(), chosen.result.notes.end(), line) == chosen.result.notes.end())
      decisions.push_back(line);
  }
  // No timings: the same take gives the same bytes.
  return {
      {"space", setup.basis.from_training ? "training" : "surface"},
      {"decisions", decisions},
      {"warnings", warnings},
      {"table", table},
      {"global_errors", "errors_global.csv"},
      {"stabilization", {{"method", take.report.head_method}, {"rms_mm", residuals_json(take.report.head_residuals)}}},
      {"solve", {{"worst_kkt_residual", chosen.result.worst_kkt_residual}, {"iterations", chosen.result.iterations}}}};
}

std::string row_name(int regions) { return std::to_string(regions) + " regions"; }

/// Liu's table 1: the global solve first, then by rising number of regions.
json error_table(const mocap::Take& take, const SolveSetup& setup, const Solved& global, const Solved& regional,
                 int regions, Progress& progress) {
  std::vector<retarget::ErrorSummary> rows = {retarget::summarize(regional.errors, row_name(regions), regions)};
  for (const retarget::MarkerWeights& division : setup.compared) {
    const int count = static_cast<int>(division.regions.size());
    if (count == regions) continue;
    rows.push_back(retarget::summarize(solved(take, setup, division, progress).errors, row_name(count), count));
  }
  std::stable_sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.regions < b.regions; });
  json table = {row_json(retarget::summarize(global.errors, "global", 1))};
  for (const retarget::ErrorSummary& row : rows) table.push_back(row_json(row));
  return table;
}

}  // namespace

std::vector<retarget::MarkerWeights> compared_divisions(const rig::Actor& actor, const SessionBasis& basis,
                                                        std::uint64_t seed) {
  std::vector<retarget::MarkerWeights> divisions;
  if (actor.poses.size() < 2) return divisions;
  for (const int regions : {2, 6, 9, 12}) {
    if (regions == static_cast<int>(actor.regions.size())) continue;
    rig::Actor divided = actor;
    rig::divide_face(divided, {.regions = regions, .seed = seed});
    divisions.push_back(retarget::marker_weights(divided, basis.basis.labels, basis.places()));
  }
  return divisions;
}

std::vector<std::string> solved_artefacts(const std::string& take) {
  std::vector<std::string> names;
  for (const char* file : {"weights.npy", "weights.json", "errors.csv", "errors_global.csv", "report.json"}) {
    names.push_back(take_artefact(take, file));
  }
  return names;
}

json solve_and_write(const SessionTake& take, const SolveSetup& setup, const Provenance& provenance, Manifest& session,
                     Progress& progress) {
  const mocap::Take in_space = setup.basis.in_space(take.clean);
  const std::vector<std::string>& labels = setup.basis.basis.labels;
  const Solved global = solved(in_space, setup, retarget::MarkerWeights::global(labels), progress);
  const retarget::MarkerWeights by_region = retarget::marker_weights(setup.actor, labels, setup.basis.places());
  const int regions = static_cast<int>(by_region.regions.size());
  const Solved regional = solved(in_space, setup, by_region, progress);
  const Solved& chosen = setup.regional ? regional : global;
  const json table = error_table(in_space, setup, global, regional, regions, progress);

  const auto path = [&](const char* file) { return session.folder() / take_artefact(take.name, file); };
  retarget::write_weights(path("weights.npy"), chosen.result.weights);
  retarget::write_errors(path("errors.csv"), chosen.errors);
  retarget::write_errors(path("errors_global.csv"), global.errors);
  write_json(path("report.json"), report_of(take, setup, global, chosen, table));
  for (const std::string& artefact : solved_artefacts(take.name)) session.record(artefact, provenance);
  session.save();
  char line[160];
  std::snprintf(line, sizeof line, "%s: mean marker error %.3f mm globally, %.3f mm with %d regions (%.0f frames/s)",
                take.name.c_str(), retarget::summarize(global.errors, "", 1).mean,
                retarget::summarize(regional.errors, "", regions).mean, regions, regional.frames_per_second);
  progress.note(line);
  return table;
}

}  // namespace vultus::apps
