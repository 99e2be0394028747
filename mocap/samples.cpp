#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/error.h"
#include "core/files.h"
#include "core/named_values.h"
#include "mocap/clean.h"
#include "mocap/hole_reasons.h"
#include "mocap/label_edits_json.h"

namespace vultus::mocap {

namespace {

using Json = nlohmann::json;

constexpr Named<Origin> kOrigins[] = {{Origin::measured, "measured"},       {Origin::missing, "missing"},
                                      {Origin::spline, "spline"},           {Origin::rigid_group, "rigid_group"},
                                      {Origin::local_frame, "local_frame"}, {Origin::low_rank, "low_rank"}};

Origin origin_named(const std::string& name) { return value_named(kOrigins, name, "origin of a sample"); }

/// Micrometres are enough to read and keep the file short.
double rounded(double mm) { return std::round(mm * 1000.0) / 1000.0; }

Json number_or_null(double value) { return std::isfinite(value) ? Json(rounded(value)) : Json(nullptr); }

/// Runs of one origin: [first frame, last frame, origin, [expected error of each frame]] (no errors for holes).
Json runs_of(const CleanReport& report, std::size_t marker) {
  const std::size_t markers = report.labels.size(), frames = report.origins.size() / markers;
  Json runs = Json::array();
  for (std::size_t f = 0; f < frames;) {
    const Origin origin = report.origins[f * markers + marker];
    std::size_t end = f;
    Json errors = Json::array();
    for (; end < frames && report.origins[end * markers + marker] == origin; ++end) {
      errors.push_back(rounded(report.expected_errors[end * markers + marker]));
    }
    if (origin == Origin::missing) errors = Json::array();
    if (origin != Origin::measured) runs.push_back({f, end - 1, name_of(origin), errors});
    f = end;
  }
  return runs;
}

/// "first" and "last" of an entry.
std::pair<int, int> stretch_of(const Json& json, std::size_t frames) {
  const auto first = json.at("first").get<std::int64_t>(), last = json.at("last").get<std::int64_t>();
  if (first < 0 || last < first || last >= static_cast<std::int64_t>(frames))
    throw InputError("frames " + std::to_string(first) + " to " + std::to_string(last) + " do not fit");
  return {static_cast<int>(first), static_cast<int>(last)};
}

void read_runs(const Json& runs, std::size_t marker, CleanReport& report) {
  const std::size_t markers = report.labels.size(), frames = report.origins.size() / markers;
  for (const Json& run : runs) {
    const auto first = run.at(0).get<std::size_t>(), last = run.at(1).get<std::size_t>();
    const Json& errors = run.at(3);
    if (last < first || last >= frames || (!errors.empty() && errors.size() != last - first + 1)) {
      throw InputError("a run of frames " + std::to_string(first) + " to " + std::to_string(last) + " does not fit");
    }
    for (std::size_t f = first; f <= last; ++f) {
      report.origins[f * markers + marker] = origin_named(run.at(2).get<std::string>());
      if (!errors.empty()) report.expected_errors[f * markers + marker] = errors[f - first].get<float>();
    }
  }
}

/// [frame of the take, frame of the file] wherever the difference of the two changes.
Json file_frame_runs(const std::vector<int>& file_frames) {
  Json runs = Json::array();
  for (std::size_t f = 0; f < file_frames.size(); ++f)
    if (f == 0 || file_frames[f] != file_frames[f - 1] + 1) runs.push_back({f, file_frames[f]});
  return runs;
}

std::vector<int> read_file_frames(const Json& runs, std::size_t frames) {
  std::vector<int> result(frames, 0);
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const auto first = runs[r].at(0).get<std::size_t>();
    const std::size_t end = r + 1 < runs.size() ? runs[r + 1].at(0).get<std::size_t>() : frames;
    const int number = runs[r].at(1).get<int>();
    if (end > frames || first >= end || number < (first == 0 ? 0 : result[first - 1]) || (r == 0 && first != 0))
      throw InputError("'file_frames' does not rise or does not fit " + std::to_string(frames) + " frames");
    for (std::size_t f = first; f < end; ++f) result[f] = number + static_cast<int>(f - first);
  }
  return result;
}

Json head_json(const CleanReport& report) {
  Json head = {
      {"method", report.head_method}, {"markers", report.head_markers}, {"deviations_mm", report.head_deviations},
      {"rms_mm", report.head_rms},    {"residuals_mm", Json::array()},  {"slips", Json::array()}};
  for (const double value : report.head_residuals) head["residuals_mm"].push_back(number_or_null(value));
  for (const JigSlip& slip : report.slips) {
    head["slips"].push_back({{"marker", slip.label},
                             {"frame", slip.frame},
                             {"settled", slip.settled < 0 ? Json(nullptr) : Json(slip.settled)},
                             {"distance_mm", rounded(slip.distance)}});
  }
  return head;
}

void read_head(const Json& head, CleanReport& report) {
  report.head_method = head.at("method").get<std::string>();
  report.head_markers = head.at("markers").get<std::vector<std::string>>();
  report.head_deviations = head.at("deviations_mm").get<std::vector<double>>();
  report.head_rms = head.at("rms_mm").get<double>();
  for (const Json& value : head.at("residuals_mm")) {
    report.head_residuals.push_back(value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>());
  }
  for (const Json& slip : head.value("slips", Json::array())) {
    const Json& settled = slip.at("settled");
    report.slips.push_back({slip.at("marker").get<std::string>(), slip.at("frame").get<int>(),
                            settled.is_null() ? -1 : settled.get<int>(), slip.at("distance_mm").get<double>()});
  }
}

CleanReport parsed(const Json& json) {
  CleanReport report;
  report.take = json.at("take").get<std::string>();
  report.rate_hz = json.at("rate_hz").get<double>();
  report.decisions = json.at("decisions").get<std::vector<std::string>>();
  report.warnings = json.value("warnings", std::vector<std::string>());
  read_head(json.at("head"), report);
  const auto frames = json.at("frames").get<std::size_t>();
  for (const Json& marker : json.at("markers")) {
    report.labels.push_back(marker.at("label").get<std::string>());
    report.missing.push_back(marker.at("missing").get<double>());
  }
  // The residuals list one value a frame, so the frame count cannot exceed what the file holds.
  if (report.head_residuals.size() != frames) throw InputError("'frames' and the head's residuals disagree");
  report.origins.assign(frames * report.labels.size(), Origin::measured);
  report.expected_errors.assign(frames * report.labels.size(), 0.0F);
  for (std::size_t m = 0; m < report.labels.size(); ++m) {
    const Json& marker = json.at("markers")[m];
    read_runs(marker.at("runs"), m, report);
    for (const Json& gap : marker.at("gaps")) {
      const auto [first, last] = stretch_of(gap, frames);
      report.gaps.push_back({static_cast<int>(m), first, last, origin_named(gap.at("method").get<std::string>()),
                             gap.at("expected_error_mm").get<double>()});
    }
    for (const Json& spike : marker.at("spikes")) {
      const auto [first, last] = stretch_of(spike, frames);
      report.spikes.push_back({static_cast<int>(m), first, last, spike.at("size_mm").get<double>()});
    }
  }
  for (const Json& repeat : json.value("repeats", Json::array())) {
    // Frames as read: more than the take has.
    const auto [first, last] = stretch_of(repeat, std::numeric_limits<int>::max());
    report.repeats.push_back(
        {repeat_kind(repeat.at("what").get<std::string>()), repeat.at("marker").get<std::string>(), first, last});
  }
  if (json.contains("file_frames")) report.file_frames = read_file_frames(json.at("file_frames"), frames);
  for (const Json& edit : json.value("label_edits", Json::array())) report.label_edits.push_back(edit_of(edit));
  return report;
}

}  // namespace

std::string name_of(Origin origin) { return name_in(kOrigins, origin); }

void write_samples(const std::filesystem::path& file, const CleanReport& report) {
  Json json = {{"take", report.take},
               {"rate_hz", report.rate_hz},
               {"frames", report.head_residuals.size()},
               {"decisions", report.decisions},
               {"warnings", report.warnings}};
  json["head"] = head_json(report);
  json["markers"] = Json::array();
  for (std::size_t m = 0; m < report.labels.size(); ++m) {
    json["markers"].push_back({{"label", report.labels[m]},
                               {"missing", report.missing[m]},
                               {"runs", runs_of(report, m)},
                               {"gaps", Json::array()},
                               {"spikes", Json::array()}});
  }
  for (const Gap& gap : report.gaps) {
    Json entry = {{"first", gap.first},
                  {"last", gap.last},
                  {"method", name_of(gap.method)},
                  {"expected_error_mm", rounded(gap.expected_error)}};
    if (gap.method == Origin::missing) entry["why"] = hole_reason(report, gap);
    json["markers"][static_cast<std::size_t>(gap.marker)]["gaps"].push_back(std::move(entry));
  }
  for (const Spike& spike : report.spikes) {
    json["markers"][static_cast<std::size_t>(spike.marker)]["spikes"].push_back(
        {{"first", spike.first}, {"last", spike.last}, {"size_mm", rounded(spike.size)}});
  }
  json["repeats"] = Json::array();
  for (const RepeatNote& repeat : report.repeats) {
    json["repeats"].push_back(
        {{"what", name_of(repeat.kind)}, {"marker", repeat.marker}, {"first", repeat.first}, {"last", repeat.last}});
  }
  if (!report.file_frames.empty()) json["file_frames"] = file_frame_runs(report.file_frames);
  json["label_edits"] = Json::array();
  for (const LabelEdit& edit : report.label_edits) json["label_edits"].push_back(json_of(edit));
  write_json(file, json);
}

CleanReport read_samples(const std::filesystem::path& file) {
  const Json json = read_json(file);
  try {
    return parsed(json);
  } catch (const Json::exception& problem) {
    throw InputError(file, problem.what());
  } catch (const Error& problem) {
    throw InputError(file, problem.what());
  }
}

}  // namespace vultus::mocap
