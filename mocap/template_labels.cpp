#include "mocap/template_labels.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "core/error.h"
#include "mocap/layout_fit.h"
#include "mocap/tracklets.h"

namespace vultus::mocap {

namespace {

constexpr double kClear = 0.6;  // share of the looks at a tracklet that must agree
constexpr int kAnchors = 5;

class Follower {
 public:
  Follower(const Take& raw, const RigidBody& layout, double jump_mm) : raw_(raw), layout_(layout) {
    for (const Tracklet& t : cut_tracklets(raw, jump_mm))
      if (is_unlabelled(raw.labels[static_cast<std::size_t>(t.column)])) tracklets_.push_back(t);
    votes_.resize(tracklets_.size());
    looks_.assign(tracklets_.size(), 0);
    const int step = std::max(1, static_cast<int>(raw.rate_hz / 10.0));
    std::set<int> looked_at;
    for (int f = 0; f < raw.frames(); f += step) looked_at.insert(f);
    for (const Tracklet& t : tracklets_)
      if (t.frames() < 2 * step) looked_at.insert((t.first + t.last) / 2);
    alive_.resize(static_cast<std::size_t>(raw.frames()));
    for (std::size_t i = 0; i < tracklets_.size(); ++i)
      for (auto f = looked_at.lower_bound(tracklets_[i].first); f != looked_at.end() && *f <= tracklets_[i].last; ++f)
        alive_[static_cast<std::size_t>(*f)].push_back(static_cast<int>(i));
    looked_at_.assign(looked_at.begin(), looked_at.end());
  }

  void run() {
    const std::size_t anchor = anchor_frame();
    for (std::size_t k = anchor; k < looked_at_.size(); ++k) look(looked_at_[k]);
    carried_ = at_anchor_;
    for (std::size_t k = anchor; k-- > 0;) look(looked_at_[k]);
  }

  std::vector<LabelEdit> edits() const;

 private:
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
      const auto found = align_layout(layout_, points(looked_at_[fullest]));
      if (!found || found->matched <= fit.matched) continue;
      fit = *found;
      best = fullest;
    }
    const auto markers = static_cast<int>(layout_.labels.size());
    if (fit.matched < std::max(4, markers * 6 / 10)) {
      throw InputError(
          "take '" + raw_.name + "': the layout fits only " + std::to_string(fit.matched) + " of its " +
          std::to_string(markers) +
          " markers; give a labelled take of the same person with the same markers, or label eight by hand");
    }
    carry(looked_at_[best], fit);
    at_anchor_ = carried_;
    return best;
  }

  void look(int frame) {
    const std::vector<int>& here = alive(frame);
    if (here.size() < 4) return;
    const Points cloud = points(frame);
    std::vector<int> known(carried_.size(), -1);
    Points rows = Points::Constant(layout_.positions.rows(), 3, std::numeric_limits<double>::quiet_NaN());
    int kept = 0;
    for (std::size_t m = 0; m < known.size(); ++m) {
      const auto at = std::lower_bound(here.begin(), here.end(), carried_[m]);
      if (carried_[m] < 0 || at == here.end() || *at != carried_[m]) continue;
      known[m] = static_cast<int>(at - here.begin());
      rows.row(static_cast<Eigen::Index>(m)) = cloud.row(known[m]);
      ++kept;
    }
    std::optional<LayoutFit> fit;
    const auto pose = kept >= 6 ? fit_body(layout_, rows) : std::nullopt;
    fit = pose ? match_layout(layout_, cloud, pose->world_from_head, known) : align_layout(layout_, cloud);
    if (!fit || 2 * fit->matched < std::min<int>(static_cast<int>(here.size()), static_cast<int>(known.size()))) return;
    carry(frame, *fit);
    for (const int t : here) ++looks_[static_cast<std::size_t>(t)];
    for (std::size_t m = 0; m < carried_.size(); ++m)
      if (carried_[m] >= 0) ++votes_[static_cast<std::size_t>(carried_[m])][static_cast<int>(m)];
  }

  const Take& raw_;
  const RigidBody& layout_;
  std::vector<Tracklet> tracklets_;
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
  for (std::size_t t = 0; t < tracklets_.size(); ++t)
    for (const auto& [label, votes] : votes_[t])
      if (votes >= kClear * looks_[t]) choices.push_back({t, label, votes});
  std::stable_sort(choices.begin(), choices.end(), [](auto& a, auto& b) { return a.votes > b.votes; });
  std::map<int, std::vector<Tracklet>> taken;
  std::map<std::pair<int, int>, std::pair<LabelEdit, std::pair<int, int>>> grouped;
  for (const Choice& choice : choices) {
    const Tracklet& t = tracklets_[choice.tracklet];
    std::vector<Tracklet>& others = taken[choice.label];
    if (std::any_of(others.begin(), others.end(), [&](auto& o) { return o.first <= t.last && t.first <= o.last; }))
      continue;
    others.push_back(t);
    auto& [edit, counts] = grouped[{t.column, choice.label}];
    edit.moves.push_back({t.first, t.last, raw_.labels[static_cast<std::size_t>(t.column)],
                          layout_.labels[static_cast<std::size_t>(choice.label)]});
    counts.first += choice.votes;
    counts.second += looks_[choice.tracklet];
  }
  std::vector<LabelEdit> result;
  for (auto& [key, entry] : grouped) {
    auto& [edit, counts] = entry;
    edit.kind = LabelEdit::Kind::fragment;
    edit.score = static_cast<double>(counts.first) / counts.second;
    edit.why = "where the layout has the marker in " + std::to_string(counts.first) + " of " +
               std::to_string(counts.second) + " frames looked at";
    result.push_back(std::move(edit));
  }
  std::stable_sort(result.begin(), result.end(), [](auto& a, auto& b) { return a.first() < b.first(); });
  return result;
}

}  // namespace

Relabelled label_from_layout(const Take& raw, const RigidBody& layout, const LabelOptions& options) {
  options.validate();
  RigidBody wanted{{}, Points(0, 3), {}};
  std::vector<int> rows;
  int labelled = 0;
  for (const std::string& label : raw.labels) labelled += is_unlabelled(label) ? 0 : 1;
  if (labelled >= 8) {
    Relabelled result = repair_labels(raw, options);
    result.decisions.push_back("labels: the template was not needed, eight markers or more are labelled");
    return result;
  }
  for (std::size_t m = 0; m < layout.labels.size(); ++m)
    if (raw.find(layout.labels[m]) < 0) rows.push_back(static_cast<int>(m));
  for (const int m : rows) wanted.labels.push_back(layout.labels[static_cast<std::size_t>(m)]);
  wanted.positions = layout.positions(rows, Eigen::all);
  wanted.deviations = layout.deviations(rows);
  Follower follower(raw, wanted, options.jump_mm);
  follower.run();
  Relabelled result;
  result.edits.edits = follower.edits();
  result.take = apply_edits(raw, result.edits);
  result.decisions.push_back("labels: " + std::to_string(result.edits.edits.size()) + " given from the template");
  return result;
}

}  // namespace vultus::mocap
