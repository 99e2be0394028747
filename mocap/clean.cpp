#include "mocap/clean.h"

#include <algorithm>
#include <limits>

#include "core/named_values.h"
#include "core/number_text.h"
#include "mocap/hole_reasons.h"
#include "mocap/template_labels.h"

namespace vultus::mocap {

namespace {

constexpr Named<HeadMethod> kHeadMethods[] = {{HeadMethod::automatic, "automatic"},
                                              {HeadMethod::jig, "jig"},
                                              {HeadMethod::steady_face, "steady face markers"},
                                              {HeadMethod::three_point, "three points"}};

void append(std::vector<std::string>& to, const std::vector<std::string>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

std::vector<double> missing_shares(const Take& take) {
  std::vector<double> shares(take.labels.size(), 0.0);
  for (int f = 0; f < take.frames(); ++f) {
    for (int m = 0; m < take.markers(); ++m) shares[static_cast<std::size_t>(m)] += take.has(f, m) ? 0.0 : 1.0;
  }
  for (double& share : shares) share /= take.frames();
  return shares;
}

CleanReport report_of(const Relabelled& labelling, const Stabilized& head) {
  CleanReport report;
  report.take = head.take.name;
  report.rate_hz = head.take.rate_hz;
  report.file_frames = head.take.file_frames;
  report.head_method = name_in(kHeadMethods, head.method);
  report.head_markers = head.body.labels;
  report.head_deviations.assign(head.body.deviations.data(), head.body.deviations.data() + head.body.deviations.size());
  report.head_rms = head.rms;
  for (const HeadPose& pose : head.poses) {
    report.head_residuals.push_back(pose.kind == HeadPose::Kind::measured ? pose.rms
                                                                          : std::numeric_limits<double>::quiet_NaN());
  }
  report.slips = head.slips;
  report.label_edits = labelling.edits.edits;
  report.decisions = head.take.decisions;
  append(report.decisions, labelling.decisions);
  report.warnings = labelling.warnings;
  append(report.decisions, head.decisions);
  return report;
}

/// The raw take under the right labels, by the list in the options or by search.
Relabelled labelled(Take raw, const CleanOptions& options) {
  Relabelled result;
  if (options.label_edits) {
    result.edits = *options.label_edits;
    result.take = apply_edits(std::move(raw), result.edits);
    result.decisions = list_notes(result.edits);
    return result;
  }
  if (!options.repair_labels) {
    result.take = std::move(raw);
    return result;
  }
  if (options.layout) return label_from_layout(raw, *options.layout, options.labels);
  return repair_labels(std::move(raw), options.labels);
}

void note_repeats(const std::vector<Repeat>& repeats, const Take& take, CleanReport& report) {
  std::size_t held = 0, doubled = 0, markers = 0;
  for (const Repeat& repeat : repeats) {
    const auto frames = static_cast<std::size_t>(repeat.frames());
    const std::string marker = repeat.marker < 0 ? "" : take.labels[static_cast<std::size_t>(repeat.marker)];
    report.repeats.push_back({repeat.kind, marker, repeat.first, repeat.last});
    held += repeat.kind == Repeat::Kind::held ? frames : 0;
    doubled += repeat.kind == Repeat::Kind::doubled ? frames : 0;
    markers += repeat.kind == Repeat::Kind::marker ? frames : 0;
    if (repeat.kind == Repeat::Kind::lower_rate) {
      const std::string times = std::to_string(repeat.times);
      report.decisions.push_back("repeats: every frame stands " + times + " times in the file; the take was recorded " +
                                 "at " + number(take.rate_hz / repeat.times, "%.6g") + " Hz, not at " +
                                 number(take.rate_hz, "%.6g") + ", and only one sample in " + times + " was measured");
    }
  }
  if (held + doubled + markers == 0) return;
  report.decisions.push_back("repeats: " + std::to_string(held) + " frames held for lost ones are missing, " +
                             std::to_string(doubled) + " put in twice were taken out, " + std::to_string(markers) +
                             " samples of markers held in place are missing");
}

/// Spikes out, gaps filled. Residuals and camera masks wait beside, so that the copies that filling makes are smaller.
Filled filled_take(Take& steady, int reference_frame, const CleanOptions& options) {
  std::vector<float> residuals = std::move(steady.residuals);
  std::vector<std::uint8_t> cameras = std::move(steady.cameras);
  steady.residuals.clear();
  steady.cameras.clear();
  Filled filled = fill_gaps(std::move(steady), options.gaps);
  steady = {};
  filled.take.residuals = std::move(residuals);
  filled.take.cameras = std::move(cameras);
  add_virtual_markers(filled, reference_frame, options.virtual_markers);
  return filled;
}

}  // namespace

void CleanOptions::validate() const {
  labels.validate();
  head.validate();
  spikes.validate();
  gaps.validate();
  filter.validate();
}

Cleaned clean(Take raw, const CleanOptions& options, Progress& progress) {
  options.validate();
  progress.begin("mocap " + raw.name, 5);
  const auto step_done = [&] {
    progress.advance();
    progress.check();
  };
  Relabelled repaired = labelled(std::move(raw), options);
  step_done();
  const std::vector<Repeat> repeats = find_repeats(repaired.take);
  CleanReport notes;
  note_repeats(repeats, repaired.take, notes);
  Stabilized head = stabilize(without(std::move(repaired.take), repeats), options.head);
  step_done();
  CleanReport report = report_of(repaired, head);
  report.repeats = std::move(notes.repeats);
  append(report.decisions, notes.decisions);
  Take steady = std::move(head.take), measured;
  if (options.keep_measured) measured = steady;
  if (options.remove_spikes) {
    report.spikes = find_spikes(steady, options.spikes);
    steady = without(std::move(steady), report.spikes);
    if (!report.spikes.empty()) {
      report.decisions.push_back("spikes: " + std::to_string(report.spikes.size()) + " taken out");
    }
  }
  step_done();
  report.missing = missing_shares(steady);
  Filled filled = filled_take(steady, head.reference_frame, options);
  step_done();
  Take take = smoothed(std::move(filled.take), options.filter);
  progress.advance();
  append(report.decisions, filled.decisions);
  report.labels = take.labels;
  report.missing.resize(take.labels.size(), 1.0);
  report.gaps = std::move(filled.gaps);
  report.origins = std::move(filled.origins);
  report.expected_errors = std::move(filled.expected_errors);
  take.file_frames = report.file_frames;
  append(report.decisions, hole_reasons(report));
  return {std::move(take),       std::move(measured), std::move(head.body),
          std::move(head.poses), std::move(report),   std::move(repaired.edits)};
}

}  // namespace vultus::mocap
