#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/bench_registration/case_set.h"
#include "apps/bench_registration/leak.h"
#include "apps/bench_registration/measure.h"
#include "apps/bench_registration/openings.h"
#include "core/progress.h"
#include "register/quality.h"

namespace vultus::apps::bench {

struct BenchOptions {
  std::vector<std::string> sets = set_names();
  std::vector<std::string> methods;  ///< empty: all that registration has
  std::vector<std::string> poses;    ///< empty: all; the neutral always comes
  SetOptions set;
  std::filesystem::path pictures;  ///< folder of heat maps, or empty
  std::filesystem::path scans;     ///< folder that gets the scans and the true vertices as PLY, or empty
  void validate() const;           ///< throws `UsageError` for unknown sets and methods
};

/// One scan by one method.
struct CaseRow {
  std::string set, method, person, pose;
  std::vector<std::string> decisions;  ///< of the registration, in words
  std::string error;                   ///< why there is no result; the rest is then empty
  std::optional<Distances> distances;  ///< where the truth is known
  std::optional<Leak> leak;
  std::vector<float> scan;        ///< mm from the trusted part of the scan, noise and all, to the result
  std::vector<float> landmarks;   ///< mm to points that others placed on the scan
  std::vector<Opening> openings;  ///< of mouth and eyes, where the truth is known
  int turned_triangles = 0;       ///< of the face, by more than a right angle from the truth, where it is known
  int scan_triangles = 0;
  double peak_bytes = 0.0;  ///< of the process while the scan was cleaned and registered, test scan included
  double clean_seconds = 0.0, register_seconds = 0.0;  ///< by the clock
  double processor_seconds = 0.0;                      ///< of both, summed over threads
  registration::Quality quality;
  double seconds() const { return clean_seconds + register_seconds; }
};

struct SetResult {
  std::string name;
  std::string missing;  ///< why the set was not run; empty where it was
  std::vector<CaseRow> rows;
};

/// Runs every case after the other, so that seconds are honest; `tell` hears of each as it ends.
std::vector<SetResult> run_bench(const BenchOptions& options, Progress& progress,
                                 const std::function<void(const CaseRow&)>& tell);

}  // namespace vultus::apps::bench
