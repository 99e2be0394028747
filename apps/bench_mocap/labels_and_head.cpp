#include <cmath>
#include <cstdio>
#include <string>

#include "apps/bench_mocap/mocap_bench.h"
#include "apps/virtual_stage/actor.h"
#include "apps/virtual_stage/head_score.h"
#include "apps/virtual_stage/label_score.h"
#include "mocap/labels.h"
#include "mocap/stabilize.h"
#include "register/template_head.h"

namespace vultus::apps::bench_mocap {
namespace {

using namespace virtual_stage;

constexpr double kSeconds = 30.0, kRateHz = 120.0, kNoise = 0.1, kMissing = 0.08, kSlip = 3.0;

/// Sums over the takes.
struct Totals {
  LabelScore labels, unrepaired;
  int places = 0, frames = 0, takes = 0;
  double head_squares = 0.0;

  static void add(LabelScore& sum, const LabelScore& score) {
    sum.samples += score.samples;
    sum.right += score.right;
    sum.samples_in_swaps += score.samples_in_swaps;
    sum.right_in_swaps += score.right_in_swaps;
    sum.swaps_left += score.swaps_left;
  }
};

double share(std::size_t part, std::size_t whole) {
  return whole == 0 ? 1.0 : static_cast<double>(part) / static_cast<double>(whole);
}

nlohmann::json measure_take(const FaceModel& actor, const MarkerLayout& layout, const std::string& name,
                            std::uint64_t seed, Totals& totals) {
  VolumeOptions volume;
  volume.seed = seed;
  volume.noise = kNoise;
  volume.missing = kMissing;
  const RecordedTake recorded = record(actor, layout, perform(name, kSeconds, kRateHz, seed), volume);
  FaultOptions faults;
  faults.seed = seed;
  faults.slip_mm = kSlip;
  const FaultyTake faulty = with_faults(recorded, static_cast<int>(layout.jig.rows()), faults);
  const mocap::Relabelled repaired = mocap::repair_labels(faulty.take);
  const LabelScore score = score_labels(faulty, repaired.take), before = score_labels(faulty, faulty.take);
  Totals::add(totals.labels, score);
  Totals::add(totals.unrepaired, before);
  for (const Fault& fault : faulty.faults) totals.places += fault.kind != Fault::Kind::fragment;
  totals.frames += faulty.take.frames();
  const mocap::Stabilized head = mocap::stabilize(repaired.take);
  const double left = head_motion_left(recorded, static_cast<int>(layout.labels.size()), head.poses);
  totals.head_squares += left * left;
  ++totals.takes;
  nlohmann::json slips = nlohmann::json::array();
  for (const mocap::JigSlip& slip : head.slips)
    slips.push_back({{"marker", slip.label}, {"frame", slip.frame}, {"distance_mm", slip.distance}});
  return {{"take", name},
          {"labels_correct", share(score.right, score.samples)},
          {"labels_correct_in_swaps", share(score.right_in_swaps, score.samples_in_swaps)},
          {"swaps_left", score.swaps_left},
          {"stabilization_rms_mm", left},
          {"slip",
           {{"marker", faulty.take.labels[static_cast<std::size_t>(faulty.slipped_marker)]},
            {"first", faulty.slip_first},
            {"last", faulty.slip_last}}},
          {"slips_found", slips}};
}

std::string percent(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f %%", 100.0 * value);
  return text;
}

}  // namespace

void measure_labels_and_head(const MocapBenchOptions& options, MocapFigures& figures, Progress& progress) {
  progress.begin("labels and head", performance_names().size());
  const registration::Template head = registration::template_head();
  Totals totals;
  for (const std::string& name : performance_names()) {
    progress.check();
    const std::uint64_t seed = options.seed + static_cast<std::uint64_t>(totals.takes);
    const FaceModel actor(head, identity(head, seed + 10));
    const MarkerLayout layout = marker_layout(actor, seed);
    figures.details["labels_and_head"].push_back(measure_take(actor, layout, name, seed, totals));
    progress.advance();
  }
  const LabelScore& score = totals.labels;
  const double correct = share(score.right, score.samples),
               in_swaps = share(score.right_in_swaps, score.samples_in_swaps),
               left = std::sqrt(totals.head_squares / totals.takes);
  figures.report["labels_correct"] = correct;
  figures.report["labels_correct_in_swaps"] = in_swaps;
  figures.report["swaps_left"] = score.swaps_left;
  figures.report["stabilization_rms_mm"] = left;
  char text[256];
  std::snprintf(text, sizeof text,
                "labels: %s right (%s unrepaired), %s inside swaps, %d swaps left; %d swaps and phantoms in %d frames",
                percent(correct).c_str(), percent(share(totals.unrepaired.right, totals.unrepaired.samples)).c_str(),
                percent(in_swaps).c_str(), score.swaps_left, totals.places, totals.frames);
  figures.lines.push_back(text);
  std::snprintf(text, sizeof text, "head: %.3f mm RMS left, one of five jig markers slipping by %.0f mm", left, kSlip);
  figures.lines.push_back(text);
}

}  // namespace vultus::apps::bench_mocap
