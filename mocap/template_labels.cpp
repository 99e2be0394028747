#include "mocap/template_labels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "core/error.h"
#include "core/number_text.h"
#include "mocap/composed_edits.h"
#include "mocap/layout_fit.h"
#include "mocap/tracklets.h"

namespace vultus::mocap {

namespace {

constexpr double kClear = 0.6;  // share of the looks at a tracklet that must agree
constexpr int kAnchors = 5;
constexpr int kKnown = 6;          // markers from which on the pose needs no search
constexpr double kRefused = 1.0;   // markers by which a pose must be better than any other
constexpr double kDoubtful = 3.0;  // and below which that is worth a warning

std::string in_markers(double value) { return number(value, "%.1f"); }

/// Follows the layout through the take. Columns that bear one of its labels already help to place it and keep them.
class Follower {
 public:
  Follower(const Take& raw, const RigidBody& layout, double jump_mm) : raw_(raw), layout_(layout) {
    for (const Tracklet& t : cut_tracklets(raw, jump_mm)) {
      const std::string& label = raw.labels[static_cast<std::size_t>(t.column)];
      const auto own = std::find(layout.labels.begin(), layout.labels.end(), label);
      if (own == layout.labels.end() && !is_unlabelled(label)) continue;
      tracklets_.push_back(t);
      own_.push_back(own == layout.labels.end() ? -1 : static_cast<int>(own - layout.labels.begin()));
    }
    votes_.resize(tracklets_.size());
    looks_.assign(tracklets_.size(), 0);
    choose_frames();
  }

  void run() {
    const std::size_t anchor = anchor_frame();
    for (std::size_t k = anchor; k < looked_at_.size(); ++k) look(looked_at_[k]);
    carried_ = at_anchor_;
    for (std::size_t k = anchor; k-- > 0;) look(looked_at_[k]);
  }

  std::vector<LabelEdit> edits() const;
  std::vector<std::string> decisions, warnings;

 private:
  void choose_frames() {
    const int step = std::max(1, static_cast<int>(raw_.rate_hz / 10.0));
    std::set<int> looked_at;
    for (int f = 0; f < raw_.frames(); f += step) looked_at.insert(f);
    for (const Tracklet& t : tracklets_)
      if (t.frames() < 2 * step) looked_at.insert((t.first + t.last) / 2);
    alive_.resize(static_cast<std::size_t>(raw_.frames()));
    for (std::size_t i = 0; i < tracklets_.size(); ++i)
      for (auto f = looked_at.lower_bound(tracklets_[i].first); f != looked_at.end() && *f <= tracklets_[i].last; ++f)
        alive_[static_cast<std::size_t>(*f)].push_back(static_cast<int>(i));
    looked_at_.assign(looked_at.begin(), looked_at.end());
  }

  const std::vector<int>& alive(int frame) const { return alive_[static_cast<std::size_t>(frame)]; }

  Points points(int frame) const {
    Points result(static_cast<Eigen::Index>(alive(frame).size()), 3);
    for (Eigen::Index i = 0; i < result.rows(); ++i) {
      const auto t = static_cast<std::size_t>(alive(frame)[static_cast<std::size_t>(i)]);
      result.row(i) = raw_.at(frame, tracklets_[t].column).transpose();
    }
    return result;
  }

  void carry(int frame, const LayoutFit& fit) {
    carried_.assign(fit.points.size(), -1);
    for (std::size_t m = 0; m < carried_.size(); ++m)
      if (fit.points[m] >= 0) carried_[m] = alive(frame)[static_cast<std::size_t>(fit.points[m])];
  }

  /// The layout laid over a frame: from where labels and the frame before put it, else by search.
  std::optional<LayoutFit> fit_at(int frame) const {
    const std::vector<int>& here = alive(frame);
    const Points cloud = points(frame);
    std::vector<int> known(layout_.labels.size(), -1);
    Points rows = Points::Constant(layout_.positions.rows(), 3, std::numeric_limits<double>::quiet_NaN());
    int kept = 0;
    const auto keep = [&](int marker, std::size_t at) {
      if (marker < 0 || known[static_cast<std::size_t>(marker)] >= 0) return;
      known[static_cast<std::size_t>(marker)] = static_cast<int>(at);
      rows.row(marker) = cloud.row(static_cast<Eigen::Index>(at));
      ++kept;
    };
    for (std::size_t i = 0; i < here.size(); ++i) keep(own_[static_cast<std::size_t>(here[i])], i);
    for (std::size_t m = 0; m < carried_.size(); ++m) {
      const auto at = std::lower_bound(here.begin(), here.end(), carried_[m]);
      if (carried_[m] >= 0 && at != here.end() && *at == carried_[m])
        keep(static_cast<int>(m), static_cast<std::size_t>(at - here.begin()));
    }
    const auto pose = kept >= kKnown ? fit_body(layout_, rows) : std::nullopt;
    return pose ? match_layout(layout_, cloud, pose->world_from_head, known) : align_layout(layout_, cloud);
  }

  /// Of the frames with most points, spread over the take, the one that the layout fits best; its number in
  /// `looked_at_`.
  std::size_t anchor_frame() {
    std::size_t best = 0;
    LayoutFit fit;
    for (int part = 0; part < kAnchors; ++part) {
      const std::size_t first = looked_at_.size() * static_cast<std::size_t>(part) / kAnchors;
      const std::size_t end = looked_at_.size() * static_cast<std::size_t>(part + 1) / kAnchors;
      if (first == end) continue;
      std::size_t fullest = first;
      for (std::size_t k = first; k < end; ++k)
        if (alive(looked_at_[k]).size() > alive(looked_at_[fullest]).size()) fullest = k;
      if (alive(looked_at_[fullest]).size() < 4) continue;
      const auto found = fit_at(looked_at_[fullest]);
      if (!found || found->matched == 0 || (fit.matched > 0 && found->cost >= fit.cost)) continue;
      fit = *found;
      best = fullest;
    }
    check(fit, best);
    carry(looked_at_[best], fit);
    at_anchor_ = carried_;
    return best;
  }

  /// Refuses a layout that does not fit, or about as well another way round.
  void check(const LayoutFit& fit, std::size_t anchor) {
    const auto markers = static_cast<int>(layout_.labels.size());
    const std::string take = "take '" + raw_.name + "': ";
    if (fit.matched < std::max(4, markers * 6 / 10)) {
      throw InputError(
          take + "the layout fits only " + std::to_string(fit.matched) + " of its " + std::to_string(markers) +
          " markers; give a labelled take of the same person with the same markers, or label eight by hand");
    }
    std::string found = "the layout is laid over frame " + std::to_string(looked_at_[anchor]) + " with a cost of " +
                        in_markers(fit.cost) + " of " + std::to_string(markers) + " markers";
    if (std::isfinite(fit.rival_cost)) found += "; the best of the other poses costs " + in_markers(fit.rival_cost);
    if (fit.margin() < kRefused) {
      throw InputError(take + found +
                       ", too little to tell them apart: the markers lie about the same when they are turned round; "
                       "label six or more by hand, on both sides, and run this again");
    }
    if (fit.margin() < kDoubtful)
      warnings.push_back("labels: the layout fits almost as well turned round: look at left and right");
    decisions.push_back("labels: " + found);
  }

  void look(int frame) {
    const std::vector<int>& here = alive(frame);
    if (here.size() < 4) return;
    const auto fit = fit_at(frame);
    if (!fit || 2 * fit->matched < std::min<int>(static_cast<int>(here.size()), static_cast<int>(fit->points.size())))
      return;
    if (fit->margin() < kRefused) return;
    carry(frame, *fit);
    for (const int t : here) ++looks_[static_cast<std::size_t>(t)];
    for (std::size_t m = 0; m < carried_.size(); ++m)
      if (carried_[m] >= 0) ++votes_[static_cast<std::size_t>(carried_[m])][static_cast<int>(m)];
  }

  const Take& raw_;
  const RigidBody& layout_;
  std::vector<Tracklet> tracklets_;
  std::vector<int> own_;                   // marker whose label the tracklet's column bears, -1: none
  std::vector<std::map<int, int>> votes_;  // of each tracklet for markers of the layout
  std::vector<int> looks_;
  std::vector<int> looked_at_;
  std::vector<std::vector<int>> alive_;   // tracklets in the frames looked at
  std::vector<int> carried_, at_anchor_;  // tracklet of each marker
};

/// One edit for each column and label, those with most looks first to take a label's frames.
std::vector<LabelEdit> Follower::edits() const {
  struct Choice {
    std::size_t tracklet;
    int label, votes;
  };
  std::vector<Choice> choices;
  std::map<int, std::vector<Tracklet>> taken;
  for (std::size_t t = 0; t < tracklets_.size(); ++t)
    if (own_[t] >= 0) taken[own_[t]].push_back(tracklets_[t]);
  for (std::size_t t = 0; t < tracklets_.size(); ++t)
    for (const auto& [label, votes] : votes_[t])
      if (own_[t] < 0 && votes >= kClear * looks_[t]) choices.push_back({t, label, votes});
  std::stable_sort(choices.begin(), choices.end(), [](auto& a, auto& b) { return a.votes > b.votes; });
  struct Group {
    LabelEdit edit;
    int votes = 0, looks = 0;
  };
  std::map<std::pair<int, int>, Group> groups;
  for (const Choice& choice : choices) {
    const Tracklet& t = tracklets_[choice.tracklet];
    std::vector<Tracklet>& others = taken[choice.label];
    if (std::any_of(others.begin(), others.end(), [&](auto& o) { return o.first <= t.last && t.first <= o.last; }))
      continue;
    others.push_back(t);
    Group& group = groups[{t.column, choice.label}];
    group.edit.moves.push_back({t.first, t.last, raw_.labels[static_cast<std::size_t>(t.column)],
                                layout_.labels[static_cast<std::size_t>(choice.label)]});
    group.votes += choice.votes;
    group.looks += looks_[choice.tracklet];
  }
  std::vector<LabelEdit> result;
  for (auto& [key, group] : groups) {
    group.edit.kind = LabelEdit::Kind::fragment;
    group.edit.score = static_cast<double>(group.votes) / group.looks;
    group.edit.why = "where the layout has the marker in " + std::to_string(group.votes) + " of " +
                     std::to_string(group.looks) + " frames looked at";
    result.push_back(std::move(group.edit));
  }
  std::stable_sort(result.begin(), result.end(), [](auto& a, auto& b) { return a.first() < b.first(); });
  return result;
}

}  // namespace

Relabelled label_from_layout(const Take& raw, const RigidBody& layout, const LabelOptions& options) {
  options.validate();
  const bool complete = std::none_of(raw.labels.begin(), raw.labels.end(), is_unlabelled) ||
                        std::all_of(layout.labels.begin(), layout.labels.end(),
                                    [&](const std::string& label) { return raw.find(label) >= 0; });
  if (complete) {
    Relabelled result = repair_labels(raw, options);
    result.decisions.insert(result.decisions.begin(), "labels: the template was not needed");
    return result;
  }
  Follower follower(raw, layout, options.jump_mm);
  follower.run();
  LabelEdits given{raw.name, raw.labels, follower.edits(), {}};
  Relabelled result = repair_labels(apply_edits(raw, given), options);
  result.edits.edits = composed(given.edits, result.edits.edits);
  result.take = apply_edits(raw, result.edits);
  follower.decisions.push_back("labels: " + std::to_string(given.edits.size()) + " given from the template");
  result.decisions.insert(result.decisions.begin(), follower.decisions.begin(), follower.decisions.end());
  result.warnings.insert(result.warnings.begin(), follower.warnings.begin(), follower.warnings.end());
  return result;
}

}  // namespace vultus::mocap
