#include "mocap/label_doubts.h"

#include <algorithm>
#include <set>

#include "core/number_text.h"

namespace vultus::mocap {

namespace {

constexpr double kMany = 0.01;          // share of the samples
constexpr double kLongSeconds = 0.1;    // of a stretch that was dropped; a phantom in a gap is often shorter
constexpr double kAbsentSeconds = 0.5;  // after which a marker may be anywhere
constexpr double kLeapMm = 3.0;         // half the distance of the nearest markers on a face
constexpr double kThere = 0.5;          // of the leap: nearer to the other's place than to its own
constexpr std::size_t kListed = 5;

/// A label whose samples go on elsewhere, after a jump or an absence. In head coordinates.
struct Leap {
  int label, frame;  // the first at the new place
  Eigen::Vector3d from, to;
};

/// Under the label of a tracklet, or the one that it was dropped from: then both ends of half a swap are seen. Spikes,
/// and what is far from the label's place (a lost marker written as zero), count as absence.
std::vector<std::vector<Tracklet>> tracklets_by_label(const LabelEvidence& evidence, const std::vector<int>& original) {
  std::vector<std::vector<Tracklet>> result(static_cast<std::size_t>(evidence.labels()));
  for (std::size_t i = 0; i < original.size(); ++i) {
    const LabelledTracklet& t = evidence.tracklets()[i];
    const int label = t.label >= 0 ? t.label : original[i];
    const bool spike = t.span.frames() < kSpikeSeconds * evidence.rate_hz();
    if (label >= 0 && !spike && evidence.is_near(t.span, label))
      result[static_cast<std::size_t>(label)].push_back(t.span);
  }
  for (auto& list : result) std::ranges::stable_sort(list, {}, &Tracklet::first);
  return result;
}

/// By frame.
std::vector<Leap> leaps(const LabelEvidence& evidence, const std::vector<int>& original) {
  std::vector<Leap> result;
  const auto by_label = tracklets_by_label(evidence, original);
  for (std::size_t label = 0; label < by_label.size(); ++label) {
    for (std::size_t i = 1; i < by_label[label].size(); ++i) {
      const Tracklet &was = by_label[label][i - 1], &is = by_label[label][i];
      if (is.first <= was.last || is.first - was.last > kAbsentSeconds * evidence.rate_hz()) continue;
      const Eigen::Vector3d from = evidence.place(was, was.last), to = evidence.place(is, is.first);
      if ((to - from).norm() >= kLeapMm) result.push_back({static_cast<int>(label), is.first, from, to});
    }
  }
  std::ranges::stable_sort(result, {}, &Leap::frame);
  return result;
}

/// The leap, at about the same time, away from the place that `leap` goes to; null: none.
const Leap* makes_room(const std::vector<Leap>& leaps, const Leap& leap, double rate_hz) {
  const int near = static_cast<int>(kAbsentSeconds * rate_hz);
  const auto first = std::ranges::lower_bound(leaps, leap.frame - near, {}, &Leap::frame);
  const auto end = std::ranges::upper_bound(leaps, leap.frame + near, {}, &Leap::frame);
  const Leap* found = nullptr;
  double least = kThere * (leap.to - leap.from).norm();
  for (auto other = first; other != end; ++other) {
    const double distance = (leap.to - other->from).norm();
    if (other->label == leap.label || distance >= least) continue;
    least = distance;
    found = &*other;
  }
  return found;
}

/// Labels that take each other's places in turn, two or three: fast motion leads to new places, not round.
std::vector<std::string> exchanges(const LabelEvidence& evidence, const std::vector<Leap>& leaps) {
  std::vector<std::string> found;
  std::set<const Leap*> told;
  for (const Leap& leap : leaps) {
    std::vector<const Leap*> round = {&leap};
    const Leap* next = makes_room(leaps, leap, evidence.rate_hz());
    while (next != nullptr && next != &leap && round.size() < 3) {
      round.push_back(next);
      next = makes_room(leaps, *next, evidence.rate_hz());
    }
    if (next != &leap || told.contains(&leap)) continue;
    std::string labels;
    for (const Leap* each : round) labels += (labels.empty() ? "" : "/") + evidence.name(each->label);
    told.insert(round.begin(), round.end());
    found.push_back(labels + " at frame " + std::to_string(leap.frame));
  }
  return found;
}

/// Stretches dropped from a label that another label's samples were moved to.
std::vector<std::string> half_swaps(const LabelEvidence& evidence, const std::vector<int>& original) {
  const std::vector<LabelledTracklet>& all = evidence.tracklets();
  std::vector<std::string> found;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Tracklet& t = all[i].span;
    if (all[i].label >= 0 || original[i] < 0 || t.frames() < kLongSeconds * evidence.rate_hz()) continue;
    bool replaced = false;
    for (std::size_t k = 0; k < all.size() && !replaced; ++k) {
      replaced = all[k].label == original[i] && original[k] >= 0 && original[k] != original[i] &&
                 all[k].span.first <= t.last && t.first <= all[k].span.last;
    }
    if (!replaced) continue;
    found.push_back(evidence.name(original[i]) + " in frames " + std::to_string(t.first) + " to " +
                    std::to_string(t.last));
  }
  return found;
}

/// Share of the labelled samples that lost or changed their label.
double wrong_share(const LabelEvidence& evidence, const std::vector<int>& original) {
  double wrong = 0.0, labelled = 0.0;
  for (std::size_t i = 0; i < original.size(); ++i) {
    const LabelledTracklet& t = evidence.tracklets()[i];
    if (original[i] < 0) continue;
    labelled += t.span.frames();
    if (t.label != original[i]) wrong += t.span.frames();
  }
  return labelled > 0.0 ? wrong / labelled : 0.0;
}

/// "WHAT: A, B, C"; of more than five the first.
void add(const std::string& what, const std::vector<std::string>& places, std::vector<std::string>& doubts) {
  if (places.empty()) return;
  std::string text = what;
  for (std::size_t i = 0; i < std::min(kListed, places.size()); ++i) text += (i == 0 ? ": " : ", ") + places[i];
  if (places.size() > kListed) text += " and " + std::to_string(places.size() - kListed) + " more";
  doubts.push_back(text);
}

}  // namespace

std::vector<std::string> label_doubts(const LabelEvidence& evidence, const std::vector<int>& original) {
  std::vector<std::string> doubts;
  add("labels: some change places, as at the ends of a swap that is still there",
      exchanges(evidence, leaps(evidence, original)), doubts);
  add("labels: some are dropped where another marker took the label, maybe half of a swap",
      half_swaps(evidence, original), doubts);
  const double wrong = wrong_share(evidence, original);
  if (wrong > kMany) {
    doubts.push_back("labels: " + number(100.0 * wrong, "%.1f") +
                     " % of the samples were under wrong labels; among so many, some may not be found");
  }
  return doubts;
}

}  // namespace vultus::mocap
