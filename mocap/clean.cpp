#include "mocap/clean.h"

#include <algorithm>
#include <iterator>
#include <limits>

#include "core/error.h"
#include "mocap/template_labels.h"

namespace vultus::mocap {

namespace {

const char* name_of(HeadMethod method) {
  switch (method) {
    case HeadMethod::jig:
      return "jig";
    case HeadMethod::steady_face:
      return "steady face markers";
    case HeadMethod::three_point:
      return "three points";
    case HeadMethod::automatic:
      break;
  }
  return "automatic";
}

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

CleanReport report_of(const Take& raw, const Relabelled& labelling, const Stabilized& head) {
  CleanReport report;
  report.take = raw.name;
  report.rate_hz = raw.rate_hz;
  report.head_method = name_of(head.method);
  report.head_markers = head.body.labels;
  report.head_deviations.assign(head.body.deviations.data(), head.body.deviations.data() + head.body.deviations.size());
  report.head_rms = head.rms;
  for (const HeadPose& pose : head.poses) {
    report.head_residuals.push_back(pose.kind == HeadPose::Kind::measured ? pose.rms
                                                                          : std::numeric_limits<double>::quiet_NaN());
  }
  report.slips = head.slips;
  std::ranges::copy_if(labelling.edits.edits, std::back_inserter(report.label_edits), &LabelEdit::applied);
  report.decisions = raw.decisions;
  append(report.decisions, labelling.decisions);
  append(report.decisions, head.decisions);
  return report;
}

/// The raw take under the right labels, by the list in the options or by search.
Relabelled labelled(const Take& raw, const CleanOptions& options) {
  if (!options.label_edits && options.layout) return label_from_layout(raw, *options.layout, options.labels);
  if (!options.label_edits) return repair_labels(raw, options.labels);
  Relabelled result;
  result.edits = *options.label_edits;
  result.take = apply_edits(raw, result.edits);
  result.decisions.push_back("labels: " + std::to_string(result.edits.edits.size()) + " changes by the given list");
  return result;
}

void note_repeats(const std::vector<Repeat>& repeats, const std::vector<std::string>& labels, CleanReport& report) {
  std::size_t held = 0, doubled = 0, markers = 0;
  for (const Repeat& repeat : repeats) {
    const auto frames = static_cast<std::size_t>(repeat.frames());
    const std::string marker = repeat.marker < 0 ? "" : labels[static_cast<std::size_t>(repeat.marker)];
    report.repeats.push_back({repeat.kind, marker, repeat.first, repeat.last});
    (repeat.kind == Repeat::Kind::held ? held : repeat.kind == Repeat::Kind::doubled ? doubled : markers) += frames;
  }
  if (repeats.empty()) return;
  report.decisions.push_back("repeats: " + std::to_string(held) + " frames held for lost ones are missing, " +
                             std::to_string(doubled) + " put in twice were taken out, " + std::to_string(markers) +
                             " samples of markers held in place are missing");
}

}  // namespace

void CleanOptions::validate() const {
  labels.validate();
  head.validate();
  spikes.validate();
  gaps.validate();
  filter.validate();
}

Cleaned clean(const Take& raw, const CleanOptions& options, Progress& progress) {
  options.validate();
  progress.begin("mocap " + raw.name, 5);
  Relabelled repaired;
  const bool relabel = options.repair_labels || options.label_edits;
  if (relabel) repaired = labelled(raw, options);
  progress.advance();
  progress.check();
  const std::vector<Repeat> repeats = find_repeats(relabel ? repaired.take : raw);
  const std::vector<std::string> labels = relabel ? repaired.take.labels : raw.labels;
  if (!repeats.empty()) repaired.take = without(relabel ? repaired.take : raw, repeats);
  Stabilized head = stabilize(relabel || !repeats.empty() ? repaired.take : raw, options.head);
  repaired.take = {};
  progress.advance();
  progress.check();
  CleanReport report = report_of(raw, repaired, head);
  note_repeats(repeats, labels, report);
  Take steady = std::move(head.take), measured;
  if (options.keep_measured) measured = steady;
  if (options.remove_spikes) {
    report.spikes = find_spikes(steady, options.spikes);
    steady = without(steady, report.spikes);
    if (!report.spikes.empty()) {
      report.decisions.push_back("spikes: " + std::to_string(report.spikes.size()) + " taken out");
    }
  }
  progress.advance();
  progress.check();
  Filled filled = fill_gaps(steady, options.gaps);
  add_virtual_markers(filled, head.reference_frame, options.virtual_markers);
  progress.advance();
  progress.check();
  Take take = smoothed(filled.take, options.filter);
  progress.advance();
  append(report.decisions, filled.decisions);
  report.labels = take.labels;
  report.missing = missing_shares(steady);
  report.missing.resize(take.labels.size(), 1.0);
  report.gaps = std::move(filled.gaps);
  report.origins = std::move(filled.origins);
  report.expected_errors = std::move(filled.expected_errors);
  return {std::move(take),       std::move(measured), std::move(head.body),
          std::move(head.poses), std::move(report),   std::move(repaired.edits)};
}

}  // namespace vultus::mocap
