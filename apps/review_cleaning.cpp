#include "apps/review_cleaning.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "apps/cleaned_frames.h"
#include "apps/review_encoding.h"
#include "mocap/rigid_body.h"

namespace vultus::apps {
namespace {

using nlohmann::json;

constexpr std::size_t kMostPlaces = 1'500'000;
constexpr double kPlaceStep = 0.005;  // mm: 65534 of them are a third of a metre

json gaps_json(const mocap::CleanReport& samples) {
  json rows = json::array();
  for (const mocap::Gap& gap : samples.gaps) {
    rows.push_back({{"marker", samples.labels[gap.marker]},
                    {"first", gap.first},
                    {"last", gap.last},
                    {"method", mocap::name_of(gap.method)},
                    {"expected_error_mm", finite_or_null(gap.expected_error)}});
  }
  return rows;
}

void add_once(json& labels, const std::string& label) {
  if (!label.empty() && std::find(labels.begin(), labels.end(), label) == labels.end()) labels.push_back(label);
}

json refused_json(const mocap::LabelEdit& edit, const CleanedFrames& cleaned) {
  json markers = json::array();
  for (const mocap::LabelMove& move : edit.moves) add_once(markers, move.from);
  return {{"kind", "refused"},
          {"first", cleaned(edit.first())},
          {"last", cleaned(edit.last())},
          {"markers", markers},
          {"what", mocap::name_of(edit.kind) + " refused by hand; the samples stay under " + edit.sources()},
          {"marks", json::array()}};
}

json edit_json(const mocap::LabelEdit& edit, const CleanedFrames& cleaned) {
  if (!edit.applied) return refused_json(edit, cleaned);
  json markers = json::array(), marks = json::array(), moves = json::array();
  for (const mocap::LabelMove& move : edit.moves) {
    const std::string& row = move.to.empty() ? move.from : move.to;
    add_once(markers, row);
    marks.push_back({row, cleaned(move.first), cleaned(move.last)});
    add_once(moves, move.from + " → " + (move.to.empty() ? "dropped" : move.to));
  }
  std::string what;
  for (const auto& move : moves) what += (what.empty() ? "" : ", ") + move.get<std::string>();
  return {{"kind", mocap::name_of(edit.kind)},
          {"first", cleaned(edit.first())},
          {"last", cleaned(edit.last())},
          {"markers", markers},
          {"what", what + (edit.why.empty() ? "" : ": " + edit.why)},
          {"marks", marks}};
}

json repeat_json(const mocap::RepeatNote& repeat, const CleanedFrames& cleaned) {
  const int frames = repeat.last - repeat.first + 1, first = cleaned(repeat.first);
  const std::string count = fmt::format("{} frame{}", frames, frames == 1 ? "" : "s");
  json result = {{"kind", mocap::name_of(repeat.kind)},
                 {"first", first},
                 {"last", cleaned(repeat.last)},
                 {"markers", json::array()},
                 {"marks", json::array()}};
  if (repeat.kind == mocap::Repeat::Kind::doubled) {
    result["last"] = first;
    result["what"] = count + " put in twice, taken out";
  } else if (repeat.kind == mocap::Repeat::Kind::held) {
    result["what"] = count + " lost and held by the one before, filled";
  } else {
    result["what"] = "held in place for " + count + ", filled";
    result["markers"].push_back(repeat.marker);
    result["marks"].push_back({repeat.marker, first, result["last"]});
  }
  return result;
}

json spike_json(const mocap::Spike& spike, const std::string& label) {
  return {{"kind", "spike"},
          {"first", spike.first},
          {"last", spike.last},
          {"markers", {label}},
          {"what", fmt::format("spike of {:.1f} mm removed", spike.size)},
          {"marks", {{label, spike.first, spike.last}}}};
}

json slip_json(const mocap::JigSlip& slip) {
  const std::string then = slip.settled < 0 ? "left out from then on" : "left out until it rests";
  return {{"kind", "slip"},
          {"first", slip.frame},
          {"last", slip.settled < 0 ? slip.frame : slip.settled},
          {"markers", {slip.label}},
          {"what", fmt::format("slips by {:.2f} mm on the jig, {}", slip.distance, then)},
          {"marks", json::array()}};
}

json repairs_json(const mocap::CleanReport& samples) {
  const CleanedFrames cleaned(samples.repeats);
  std::vector<json> repairs;
  for (const mocap::LabelEdit& edit : samples.label_edits) repairs.push_back(edit_json(edit, cleaned));
  for (const mocap::RepeatNote& repeat : samples.repeats) {
    // A lower rate is only noticed.
    if (repeat.kind != mocap::Repeat::Kind::lower_rate) repairs.push_back(repeat_json(repeat, cleaned));
  }
  for (const mocap::Spike& spike : samples.spikes) repairs.push_back(spike_json(spike, samples.labels[spike.marker]));
  for (const mocap::JigSlip& slip : samples.slips) repairs.push_back(slip_json(slip));
  std::stable_sort(repairs.begin(), repairs.end(),
                   [](const json& a, const json& b) { return a["first"].get<int>() < b["first"].get<int>(); });
  return repairs;
}

json stabilization_json(const mocap::CleanReport& samples) {
  json residuals = json::array(), slips = json::array();
  for (double value : samples.head_residuals) residuals.push_back(finite_or_null(value));
  for (const mocap::JigSlip& slip : samples.slips) {
    slips.push_back({{"marker", slip.label}, {"frame", slip.frame}, {"distance_mm", finite_or_null(slip.distance)}});
  }
  return {{"method", samples.head_method},
          {"rms", finite_or_null(samples.head_rms)},
          {"rms_mm", residuals},
          {"slips", slips}};
}

/// Least coordinate of each marker and axis over both takes, mm; 0 for a marker never seen.
std::vector<float> least_places(const mocap::Take& measured, const mocap::Take& clean) {
  constexpr float kUnseen = std::numeric_limits<float>::infinity();
  std::vector<float> least(3 * clean.labels.size(), kUnseen);
  for (const mocap::Take* take : {&measured, &clean}) {
    const std::vector<int> columns = mocap::columns_of(*take, clean.labels);
    for (int f = 0; f < take->frames(); ++f) {
      for (std::size_t k = 0; k < least.size(); ++k) {
        const int m = columns[k / 3];
        if (m >= 0 && take->has(f, m)) least[k] = std::min(least[k], take->positions[3 * take->index(f, m) + k % 3]);
      }
    }
  }
  std::ranges::replace(least, kUnseen, 0.0F);
  return least;
}

/// frames × (markers of `clean` × 3), above `least`; NaN where missing.
std::vector<float> places_of(const mocap::Take& take, const mocap::Take& clean, const std::vector<float>& least) {
  const std::vector<int> columns = mocap::columns_of(take, clean.labels);
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(take.frames()) * least.size());
  for (int f = 0; f < take.frames(); ++f) {
    for (std::size_t k = 0; k < least.size(); ++k) {
      const int m = columns[k / 3];
      const bool here = m >= 0 && take.has(f, m);
      values.push_back(here ? take.positions[3 * take.index(f, m) + k % 3] - least[k]
                            : std::numeric_limits<float>::quiet_NaN());
    }
  }
  return values;
}

/// Expected errors of the samples that were made; 0 where measured, NaN in holes.
std::vector<float> expected_of(const mocap::CleanReport& samples) {
  std::vector<float> values = samples.expected_errors;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (samples.origins[i] == mocap::Origin::missing) values[i] = std::numeric_limits<float>::quiet_NaN();
  }
  return values;
}

json curves_json(const mocap::Take& measured, const mocap::Take& clean) {
  const std::vector<float> least = least_places(measured, clean);
  const std::size_t width = least.size();
  return {{"labels", clean.labels},
          {"least", least},
          {"measured", rows_json(places_of(measured, clean, least), width, kMostPlaces, kPlaceStep)},
          {"clean", rows_json(places_of(clean, clean, least), width, kMostPlaces, kPlaceStep)}};
}

}  // namespace

json cleaning_json(const ReviewTake& take) {
  json result = json::object();
  if (take.samples) {
    result["gaps"] = gaps_json(*take.samples);
    result["repairs"] = repairs_json(*take.samples);
    result["stabilization"] = stabilization_json(*take.samples);
  }
  if (take.measured && take.clean) {
    result["curves"] = curves_json(*take.measured, *take.clean);
    if (take.samples && take.samples->labels == take.clean->labels) {
      result["curves"]["expected"] =
          rows_json(expected_of(*take.samples), take.clean->labels.size(), kMostPlaces / 3, kPlaceStep);
    }
  }
  return result;
}

}  // namespace vultus::apps
