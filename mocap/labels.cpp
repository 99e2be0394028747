#include "mocap/labels.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "core/error.h"
#include "core/number_text.h"
#include "mocap/label_doubts.h"
#include "mocap/label_evidence.h"
#include "mocap/tracklets.h"

namespace vultus::mocap {

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr int kPasses = 4;  // a repaired neighbour places the others better

/// Frames that a label is taken in.
class Occupied {
 public:
  explicit Occupied(int labels) : ranges_(static_cast<std::size_t>(labels)) {}
  void add(int label, const Tracklet& t) { ranges_[static_cast<std::size_t>(label)][t.first] = t.last; }
  bool overlaps(int label, const Tracklet& t) const {
    const std::map<int, int>& ranges = ranges_[static_cast<std::size_t>(label)];
    const auto after = ranges.upper_bound(t.last);
    return after != ranges.begin() && std::prev(after)->second >= t.first;
  }

 private:
  std::vector<std::map<int, int>> ranges_;  // first → last
};

class Repair {
 public:
  Repair(const Take& raw, const LabelOptions& options) : options_(options), evidence_(raw, options.jump_mm) {
    for (LabelledTracklet& t : evidence_.tracklets()) original_.push_back(t.label);
  }

  void run() {
    for (int pass = 0; pass < kPasses; ++pass) {
      screen();
      grow_trust();
      if (!settle()) break;
      evidence_.refresh();
    }
  }

  std::vector<LabelEdit> edits() const;
  std::vector<std::string> doubts() const { return label_doubts(evidence_, original_); }

 private:
  struct Candidate {
    int tracklet, label;
    double fit;
  };

  double usual(int label) const {
    return std::max(options_.misfit_mm, options_.times_usual * evidence_.scatter(label));
  }

  /// Trusted is what fits the label it bears.
  void screen() {
    std::vector<LabelledTracklet>& all = evidence_.tracklets();
    tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
      LabelledTracklet& t = all[i];
      t.misfit = t.label < 0 ? kInf : evidence_.misfit(t.span, t.label);
      // A marker that is hardly ever seen, or a frame without neighbours, says nothing.
      const bool unknown = t.label >= 0 && (!std::isfinite(t.misfit) || !std::isfinite(evidence_.scatter(t.label)));
      t.trusted = unknown || (t.label >= 0 && t.misfit <= usual(t.label));
    });
    evidence_.refresh();
    if (first_misfits_.empty())
      for (const LabelledTracklet& t : all) first_misfits_.push_back(t.misfit);
  }

  /// A marker that goes where its neighbours do not tell (a new expression, a jig's target that slips) hangs together
  /// with its own past or future; a marker under a wrong label does not.
  void grow_trust() {
    std::vector<LabelledTracklet>& all = evidence_.tracklets();
    for (bool grown = true; grown;) {
      grown = false;
      for (LabelledTracklet& t : all) {
        if (t.trusted || t.label < 0) continue;
        if (evidence_.end_misfit(t.span, t.label) > std::max(1.0, 0.5 * t.misfit)) continue;
        t.trusted = grown = true;
      }
      if (grown) evidence_.refresh();
    }
  }

  /// Labels that come into question for what is not trusted, clearest first.
  std::vector<Candidate> candidates() const {
    const std::vector<LabelledTracklet>& all = evidence_.tracklets();
    std::vector<std::vector<Candidate>> found(all.size());
    tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
      if (all[i].trusted) return;
      for (int label = 0; label < evidence_.labels(); ++label) {
        if (!std::isfinite(evidence_.scatter(label)) || !evidence_.is_near(all[i].span, label)) continue;
        const double fit = evidence_.informed_misfit(all[i].span, label);
        if (label == all[i].label ? fit <= usual(label) : fits_better(all[i], label, fit)) {
          found[i].push_back({static_cast<int>(i), label, fit});
        }
      }
    });
    std::vector<Candidate> result;
    for (const auto& list : found) result.insert(result.end(), list.begin(), list.end());
    std::stable_sort(result.begin(), result.end(), [](const auto& a, const auto& b) { return a.fit < b.fit; });
    return result;
  }

  bool fits_better(const LabelledTracklet& t, int label, double fit) const {
    const double enough = std::isfinite(t.misfit) ? 0.3 * t.misfit : 0.0;
    return fit <= std::max({usual(label), 2.5, enough}) && fit <= options_.better * t.misfit;
  }

  /// What is not trusted gets the label that fits, if it is free; what nothing fits keeps its own if that is free, or
  /// is dropped. True when some label has changed.
  bool settle() {
    std::vector<LabelledTracklet>& all = evidence_.tracklets();
    Occupied occupied(evidence_.labels());
    std::vector<std::uint8_t> settled(all.size(), 0);
    bool changed = false;
    const auto give = [&](std::size_t i, int label) {
      settled[i] = 1;
      changed = changed || all[i].label != label;
      all[i].label = label;
      if (label >= 0) occupied.add(label, all[i].span);
    };
    for (std::size_t i = 0; i < all.size(); ++i)
      if (all[i].trusted) give(i, all[i].label);
    for (const Candidate& c : candidates()) {
      const auto i = static_cast<std::size_t>(c.tracklet);
      if (!settled[i] && !occupied.overlaps(c.label, all[i].span)) give(i, c.label);
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (settled[i]) continue;
      const int own = all[i].label;
      give(i, own >= 0 && !occupied.overlaps(own, all[i].span) && !is_phantom(all[i]) ? own : -1);
    }
    return changed;
  }

  /// A stretch under a label that its marker cannot have made: far from where the neighbours put the marker, and from
  /// where its own past and future put it. A loose jig or a face unlike all others would last longer, a spike less
  /// long.
  bool is_phantom(const LabelledTracklet& t) const {
    const double limit = std::max(options_.phantom_mm, 2.0 * usual(t.label));
    const double seconds = t.span.frames() / evidence_.rate_hz();
    if (seconds >= 2.0 || seconds <= kSpikeSeconds || t.misfit <= limit) return false;
    if (evidence_.informed_misfit(t.span, t.label) <= limit) return false;
    return std::isfinite(evidence_.end_misfit(t.span, t.label)) || t.misfit > 3.0 * limit;
  }

  std::vector<std::size_t> groups(const std::vector<std::size_t>& moved) const;
  LabelEdit edit_of(const std::vector<std::size_t>& moved) const;

  const LabelOptions& options_;
  LabelEvidence evidence_;
  std::vector<int> original_;          // labels before the repair
  std::vector<double> first_misfits_;  // under them
};

std::string in_mm(double value) { return number(value, "%.1f") + " mm"; }

/// For each of the moved tracklets the number of its group: moves that make room for each other belong together.
std::vector<std::size_t> Repair::groups(const std::vector<std::size_t>& moved) const {
  const std::vector<LabelledTracklet>& all = evidence_.tracklets();
  std::vector<std::size_t> group(moved.size());
  std::iota(group.begin(), group.end(), std::size_t{0});
  const auto root = [&](std::size_t i) {
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
  };
  for (std::size_t a = 0; a < moved.size(); ++a) {
    const LabelledTracklet& ta = all[moved[a]];
    for (std::size_t b = 0; b < moved.size() && ta.label >= 0; ++b) {
      const Tracklet& tb = all[moved[b]].span;
      if (original_[moved[b]] != ta.label || tb.first > ta.span.last || tb.last < ta.span.first) continue;
      group[root(a)] = root(b);
    }
  }
  for (std::size_t a = 0; a < moved.size(); ++a) group[a] = root(a);
  return group;
}

LabelEdit Repair::edit_of(const std::vector<std::size_t>& moved) const {
  LabelEdit edit;
  double before = 0.0, after = 0.0;
  bool dropped = true, from_label = false;
  for (const std::size_t i : moved) {
    const LabelledTracklet& t = evidence_.tracklets()[i];
    edit.moves.push_back({t.span.first, t.span.last, evidence_.column_name(t.span.column),
                          t.label < 0 ? std::string() : evidence_.name(t.label)});
    before = std::max(before, first_misfits_[i]);
    if (t.label >= 0) after = std::max(after, evidence_.misfit(t.span, t.label));
    dropped = dropped && t.label < 0;
    from_label = from_label || (original_[i] >= 0 && t.label >= 0);
  }
  edit.kind = dropped                  ? LabelEdit::Kind::phantom
              : !from_label            ? LabelEdit::Kind::fragment
              : edit.moves.size() == 1 ? LabelEdit::Kind::moved
                                       : LabelEdit::Kind::swap;
  const bool had_label = std::isfinite(before);
  if (dropped) {
    edit.score = had_label ? std::min(1.0, before / 20.0) : 0.5;
    edit.why = had_label ? in_mm(before) + " from where its neighbours put it, and no other marker fits"
                         : "unlabelled, and fits no marker that is missing";
  } else {
    edit.score = std::clamp(1.0 - after / (had_label ? before : 10.0), 0.0, 1.0);
    edit.why = had_label ? in_mm(before) + " from where the neighbours put it, now " + in_mm(after)
                         : "unlabelled, " + in_mm(after) + " from where the neighbours put the marker";
  }
  return edit;
}

std::vector<LabelEdit> Repair::edits() const {
  std::vector<std::size_t> moved;
  for (std::size_t i = 0; i < original_.size(); ++i) {
    const LabelledTracklet& t = evidence_.tracklets()[i];
    if (t.label != original_[i] || t.label < 0) moved.push_back(i);
  }
  const std::vector<std::size_t> group = groups(moved);
  std::map<std::size_t, std::vector<std::size_t>> together;
  for (std::size_t k = 0; k < moved.size(); ++k) together[group[k]].push_back(moved[k]);
  std::vector<LabelEdit> result;
  for (const auto& [key, members] : together) result.push_back(edit_of(members));
  std::stable_sort(result.begin(), result.end(), [](const auto& a, const auto& b) { return a.first() < b.first(); });
  return result;
}

void describe(Relabelled& result) {
  std::map<std::string, int> counts;
  for (const LabelEdit& edit : result.edits.edits) ++counts[name_of(edit.kind)];
  std::string text;
  for (const auto& [kind, count] : counts) text += (text.empty() ? "" : ", ") + std::to_string(count) + " × " + kind;
  result.decisions.push_back("labels: " + (text.empty() ? std::string("nothing to repair") : text));
}

}  // namespace

void LabelOptions::validate() const {
  for (const double value : {jump_mm, misfit_mm, phantom_mm}) {
    if (!(value > 0.0)) throw UsageError("the distances of the label options must be positive");
  }
  if (!(times_usual > 1.0)) throw UsageError("times_usual must be above 1");
  if (!(better > 0.0 && better < 1.0)) throw UsageError("better must be between 0 and 1");
}

Relabelled repair_labels(Take raw, const LabelOptions& options) {
  options.validate();
  const auto labelled = std::count_if(raw.labels.begin(), raw.labels.end(),
                                      [](const std::string& label) { return !is_unlabelled(label); });
  Relabelled result;
  if (labelled < 8 || raw.frames() < 30) {
    result.edits.take = raw.name;
    result.edits.labels = raw.labels;
    result.decisions.push_back("labels: not checked, with " + std::to_string(labelled) + " labelled markers in " +
                               std::to_string(raw.frames()) + " frames (8 in 30 are needed)");
    result.take = std::move(raw);
    return result;
  }
  {
    Repair repair(raw, options);  // its evidence is gone before the take is rewritten
    repair.run();
    result.edits.edits = repair.edits();
    result.warnings = repair.doubts();
  }
  result.take = apply_edits(std::move(raw), result.edits);
  describe(result);
  return result;
}

}  // namespace vultus::mocap
