#include "apps/bench_registration/registration_bench.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <map>

#include "apps/bench_registration/heat_map.h"
#include "apps/bench_registration/peak_memory.h"
#include "apps/bench_registration/turned_triangles.h"
#include "apps/command.h"
#include "core/error.h"
#include "core/mesh_io.h"
#include "register/consistent.h"
#include "register/face_finder.h"
#include "scan/clean.h"

namespace vultus::apps::bench {
namespace {

using registration::Registered;
using registration::Registration;

// Of all threads: what is left of a figure where other programs share the machine.
double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::string file_name(std::string words) {
  std::ranges::replace(words, ' ', '_');
  return words;
}

/// One method on one set: what it knows between the scans of a person.
struct Contender {
  std::string method;
  std::unique_ptr<Registration> registration;
  std::optional<Registered> neutral;  // of the person on the chair
};

class SetRun {
 public:
  SetRun(const CaseSet& set, const BenchOptions& options, Progress& progress,
         const std::function<void(const CaseRow&)>& tell)
      : set_(set), options_(options), progress_(progress), tell_(tell) {
    registration::RegisterOptions register_options;
    register_options.finder = std::make_shared<registration::FaceFinder>();
    for (const std::string& method : options.methods) {
      register_options.method = registration::method_named(method);
      contenders_.push_back({method, std::make_unique<Registration>(set.head(), register_options), {}});
    }
  }

  std::vector<CaseRow> run() {
    const std::vector<std::string> people = set_.people();
    std::vector<std::string> poses;
    for (const std::string& pose : set_.poses())
      if (pose == "neutral" || options_.poses.empty() || std::ranges::count(options_.poses, pose) > 0)
        poses.push_back(pose);
    progress_.begin("set " + set_.name(), people.size() * poses.size() * contenders_.size());
    for (std::size_t person = 0; person < people.size(); ++person)
      for (const std::string& pose : poses) scan(static_cast<int>(person), people[person], pose);
    return std::move(rows_);
  }

 private:
  void scan(int person, const std::string& name, const std::string& pose) {
    progress_.check();
    const ScanCase scanned = set_.make(person, pose);
    if (!options_.scans.empty()) keep(scanned, name, pose);
    CaseRow row;
    row.set = set_.name();
    row.person = name;
    row.pose = pose;
    row.scan_triangles = static_cast<int>(scanned.scan.topology->triangles().rows());
    if (scanned.truth) {
      const Registration& any = *contenders_.front().registration;
      row.leak = leak(*scanned.truth, *any.refined(), set_.measured(), scanned.scan.positions);
    }
    reset_peak_memory();
    const double processor = processor_seconds();
    const auto start = std::chrono::steady_clock::now();
    const scan::CleanScan cleaned = scan::clean_scan(scanned.scan);
    row.clean_seconds = seconds_since(start);
    row.peak_bytes = peak_memory();
    row.processor_seconds = processor_seconds() - processor;
    for (Contender& contender : contenders_) {
      CaseRow result = row;
      result.method = contender.method;
      attempt(contender, scanned, cleaned, result);
      tell_(result);
      rows_.push_back(std::move(result));
      progress_.advance();
    }
  }

  void keep(const ScanCase& scanned, const std::string& person, const std::string& pose) const {
    const std::string name = file_name(set_.name() + "_" + person + "_" + pose);
    write_ply(options_.scans / (name + ".ply"), scanned.scan);
    if (!scanned.truth) return;
    const auto& topology = contenders_.front().registration->refined();
    write_ply(options_.scans / (name + "_truth.ply"), {topology, scanned.truth->vertices, {}, {}});
  }

  void attempt(Contender& contender, const ScanCase& scanned, const scan::CleanScan& cleaned, CaseRow& row) {
    const bool neutral = row.pose == "neutral";
    if (neutral) contender.neutral.reset();
    try {
      if (!neutral && !contender.neutral) throw InputError("the neutral of " + row.person + " was not registered");
      reset_peak_memory();
      const double processor = processor_seconds();
      const auto start = std::chrono::steady_clock::now();
      Registered found;
      if (neutral)
        found = contender.registration->neutral(cleaned);
      else
        found = contender.registration->expression(*contender.neutral, cleaned);
      row.register_seconds = seconds_since(start);
      row.processor_seconds += processor_seconds() - processor;
      row.quality = found.quality;
      row.decisions = found.decisions;
      row.peak_bytes = std::max(row.peak_bytes, peak_memory());
      row.scan = scan_distances(cleaned, found, set_.measured());
      row.landmarks =
          landmark_distances(contender.registration->head(), found, scanned.placed, cleaned.report.units.mm_per_unit);
      if (scanned.truth) hold_against(*scanned.truth, found, cleaned.report.units.mm_per_unit, row);
      if (!options_.pictures.empty()) picture(scanned, cleaned, found, row);
      if (neutral) contender.neutral = std::move(found);
    } catch (const Cancelled&) {
      throw;
    } catch (const Error& problem) {
      row.error = problem.what();
    }
  }

  void hold_against(const Truth& truth, const Registered& found, double mm_per_unit, CaseRow& row) const {
    const registration::Template& head = contenders_.front().registration->head();
    row.distances = measure(truth, found, set_.measured(), mm_per_unit);
    const Points positions = in_scan_frame(found, mm_per_unit);
    row.openings = openings(head, truth.vertices, positions);
    row.turned_triangles = turned_triangles(*found.mesh.topology, set_.measured(), positions, truth.vertices);
  }

  void picture(const ScanCase& scanned, const scan::CleanScan& cleaned, const Registered& found,
               const CaseRow& row) const {
    Mesh shown = found.mesh;
    Eigen::VectorXf distance = found.quality.vertex_distance;
    if (scanned.truth) {
      const Points positions = in_scan_frame(found, cleaned.report.units.mm_per_unit);
      distance = (positions - scanned.truth->vertices).rowwise().norm().cast<float>();
    }
    const std::string name = file_name(row.set + "_" + row.method + "_" + row.person + "_" + row.pose);
    write_heat_map(options_.pictures / (name + ".png"), shown, distance, set_.measured());
  }

  const CaseSet& set_;
  const BenchOptions& options_;
  Progress& progress_;
  const std::function<void(const CaseRow&)>& tell_;
  std::vector<Contender> contenders_;
  std::vector<CaseRow> rows_;
};

}  // namespace

void BenchOptions::validate() const {
  for (const std::string& name : sets) check_name("set", name, set_names());
  for (const std::string& name : methods) check_name("method", name, registration::method_names());
}

std::vector<SetResult> run_bench(const BenchOptions& given, Progress& progress,
                                 const std::function<void(const CaseRow&)>& tell) {
  BenchOptions options = given;
  if (options.methods.empty()) options.methods = registration::method_names();
  options.validate();
  std::vector<SetResult> results;
  for (const std::string& name : options.sets) {
    SetResult result{name, "", {}};
    std::unique_ptr<CaseSet> set;
    try {
      set = case_set(name, options.set);
      result.rows = SetRun(*set, options, progress, tell).run();
    } catch (const Cancelled&) {
      throw;
    } catch (const UsageError&) {
      throw;
    } catch (const Error& problem) {
      result.missing = problem.what();
    }
    results.push_back(std::move(result));
  }
  return results;
}

}  // namespace vultus::apps::bench
