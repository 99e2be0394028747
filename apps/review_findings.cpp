#include "apps/review_findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "apps/cleaned_frames.h"
#include "core/named_values.h"

namespace vultus::apps {
namespace {

using Findings = std::vector<Finding>;

std::string text_or(const nlohmann::json& json, const char* key, const std::string& otherwise) {
  return json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : otherwise;
}

void add_warnings(const nlohmann::json& json, const std::string& take, Findings& findings) {
  if (!json.is_object() || !json.contains("warnings") || !json["warnings"].is_array()) return;
  for (const auto& warning : json["warnings"]) {
    if (!warning.is_string()) continue;
    std::string text = warning.get<std::string>();
    if (!text.empty()) text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
    const auto same = [&](const Finding& finding) { return finding.text == text; };
    if (std::none_of(findings.begin(), findings.end(), same)) {
      findings.push_back({Severity::look, text, take, "", "", -1});
    }
  }
}

void add_registration(const ReviewSession& session, Findings& findings) {
  if (!session.registration.is_object() || !session.registration.contains("poses")) return;
  for (const auto& pose : session.registration["poses"]) {
    const std::string verdict = text_or(pose, "verdict", "pass"), name = text_or(pose, "pose", "?");
    if (verdict == "pass") continue;
    const Severity severity = verdict == "fail" ? Severity::problem : Severity::look;
    findings.push_back(
        {severity, fmt::format("Registration of {}: {}", name, text_or(pose, "reason", verdict)), "", name, "", -1});
  }
}

void add_worst_markers(const ReviewTake& take, Findings& findings) {
  const auto means = retarget::mean_by_marker(*take.errors);
  const double typical = retarget::summarize(*take.errors, "", 1).mean;
  std::vector<int> order;
  for (int q = 0; q < static_cast<int>(means.size()); ++q) {
    if (means[q] > std::max(2.0 * typical, 0.5)) order.push_back(q);
  }
  std::sort(order.begin(), order.end(), [&](int a, int b) { return means[a] > means[b]; });
  if (order.size() > 3) order.resize(3);
  for (int q : order) {
    findings.push_back({Severity::look,
                        fmt::format("Marker {} is {:.2f} mm off on average; all markers {:.2f} mm",
                                    take.errors->labels[q], means[q], typical),
                        take.name, "", take.errors->labels[q], -1});
  }
}

void add_worst_frame(const ReviewTake& take, Findings& findings) {
  const auto means = retarget::mean_by_frame(*take.errors);
  int worst = -1;
  for (int f = 0; f < static_cast<int>(means.size()); ++f) {
    if (!std::isnan(means[f]) && (worst < 0 || means[f] > means[worst])) worst = f;
  }
  if (worst < 0) return;
  findings.push_back({Severity::note, fmt::format("Largest mean error: {:.2f} mm at frame {}", means[worst], worst),
                      take.name, "", "", worst});
}

void add_against_global(const ReviewTake& take, Findings& findings) {
  if (!take.global_errors || take.weights == std::nullopt || take.weights->regions.size() < 2) return;
  const double regional = retarget::summarize(*take.errors, "", 1).mean;
  const double global = retarget::summarize(*take.global_errors, "", 1).mean;
  if (!(regional > global)) return;
  findings.push_back(
      {Severity::problem,
       fmt::format("The regional solve ({:.2f} mm) is worse than the global one ({:.2f} mm)", regional, global),
       take.name, "", "", -1});
}

void add_gaps(const ReviewTake& take, Findings& findings) {
  if (!take.samples) return;
  int holes = 0, first_hole = -1;
  const mocap::Gap* worst = nullptr;
  for (const mocap::Gap& gap : take.samples->gaps) {
    if (gap.method == mocap::Origin::missing) {
      ++holes;
      first_hole = first_hole < 0 ? gap.first : std::min(first_hole, gap.first);
    } else if (worst == nullptr || gap.expected_error > worst->expected_error) {
      worst = &gap;
    }
  }
  if (holes > 0) {
    findings.push_back({Severity::look,
                        fmt::format("{} {} unfilled, the first at frame {}", holes,
                                    holes == 1 ? "gap stays" : "gaps stay", first_hole),
                        take.name, "", "", first_hole});
  }
  constexpr double kUncertain = 1.0;  // mm; below the usual marker error of a solve
  if (worst == nullptr || worst->expected_error < kUncertain) return;
  const std::string& label = take.samples->labels[worst->marker];
  findings.push_back({Severity::look,
                      fmt::format("Most uncertain filled gap: {} for {} frames from {}, expected error {:.1f} mm",
                                  label, worst->frames(), worst->first, worst->expected_error),
                      take.name, "", label, worst->first});
}

void add_stabilization(const ReviewTake& take, Findings& findings) {
  if (!take.samples) return;
  const std::vector<double>& residuals = take.samples->head_residuals;
  int worst = -1;
  for (int f = 0; f < static_cast<int>(residuals.size()); ++f) {
    if (std::isfinite(residuals[f]) && (worst < 0 || residuals[f] > residuals[worst])) worst = f;
  }
  constexpr double kUnsteady = 1.5;  // mm; a jig that sits well stays below half a millimetre
  if (worst < 0 || residuals[worst] <= kUnsteady) return;
  findings.push_back({Severity::look,
                      fmt::format("Head stabilization is off by {:.1f} mm at frame {} ({:.2f} mm over the take)",
                                  residuals[worst], worst, take.samples->head_rms),
                      take.name, "", "", worst});
}

void add_repairs(const ReviewTake& take, Findings& findings) {
  if (!take.samples) return;
  for (const mocap::JigSlip& slip : take.samples->slips) {
    findings.push_back(
        {Severity::look,
         fmt::format("Jig marker {} slips by {:.1f} mm at frame {}", slip.label, slip.distance, slip.frame), take.name,
         "", "", slip.frame});
  }
  std::vector<mocap::LabelEdit> edits = take.samples->label_edits;
  std::erase_if(edits, [](const mocap::LabelEdit& edit) { return !edit.applied; });
  if (edits.empty()) return;
  const auto& unsure = *std::ranges::min_element(edits, {}, &mocap::LabelEdit::score);
  const mocap::LabelMove& move = unsure.moves.front();
  const int frame = CleanedFrames(take.samples->repeats)(unsure.first());
  constexpr double kUnsure = 0.6;  // of the misfit taken away; a swap repaired takes away nine tenths
  findings.push_back({unsure.score < kUnsure ? Severity::look : Severity::note,
                      fmt::format("{} of labels; the least certain: {} of {} at frame {}",
                                  edits.size() == 1 ? "1 repair" : std::to_string(edits.size()) + " repairs",
                                  mocap::name_of(unsure.kind), move.to.empty() ? move.from : move.to, frame),
                      take.name, "", move.to.empty() ? move.from : move.to, frame});
}

constexpr Named<Severity> kSeverities[] = {
    {Severity::problem, "problem"}, {Severity::look, "look"}, {Severity::note, "note"}};

}  // namespace

nlohmann::json Finding::json() const {
  nlohmann::json result = {{"severity", name_in(kSeverities, severity)}, {"text", text}};
  if (!take.empty()) result["take"] = take;
  if (!pose.empty()) result["pose"] = pose;
  if (!marker.empty()) result["marker"] = marker;
  if (frame >= 0) result["frame"] = frame;
  return result;
}

std::vector<Finding> find_what_stands_out(const ReviewSession& session) {
  Findings findings;
  add_registration(session, findings);
  for (const ReviewTake& take : session.takes) {
    if (take.errors) {
      add_against_global(take, findings);
      add_worst_markers(take, findings);
      add_worst_frame(take, findings);
    }
    add_gaps(take, findings);
    add_stabilization(take, findings);
    add_repairs(take, findings);
  }
  // What was measured here comes before what the stages said on their way.
  add_warnings(session.facts, "", findings);
  add_warnings(session.registration, "", findings);
  for (const ReviewTake& take : session.takes) add_warnings(take.report, take.name, findings);
  for (const std::string& file : session.missing) {
    findings.push_back({Severity::note, "Not in the session yet: " + file, "", "", "", -1});
  }
  std::stable_sort(findings.begin(), findings.end(),
                   [](const Finding& a, const Finding& b) { return a.severity < b.severity; });
  return findings;
}

}  // namespace vultus::apps
