#include "mocap/composed_edits.h"

#include <algorithm>
#include <iterator>
#include <map>

namespace vultus::mocap {

namespace {

/// The moves of the first list, by where they lead.
class FirstMoves {
 public:
  explicit FirstMoves(const std::vector<LabelEdit>& edits) {
    for (std::size_t e = 0; e < edits.size(); ++e) {
      for (const LabelMove& move : edits[e].moves) {
        if (edits[e].applied && !move.to.empty())
          into_[move.to][move.first] = {e, move};
        else
          rest_.emplace_back(e, move);
      }
    }
  }

  /// Takes the samples that stand under `move.from` after the first list out of it and says where they come from.
  std::vector<LabelMove> traced(const LabelMove& move) {
    std::vector<LabelMove> result;
    auto& moves = into_[move.from];
    for (int f = move.first; f <= move.last;) {
      auto at = moves.upper_bound(f);
      const int next = at == moves.end() ? move.last + 1 : std::min(move.last + 1, at->first);
      if (at == moves.begin() || std::prev(at)->second.move.last < f) {
        result.push_back({f, next - 1, move.from, move.to});
        f = next;
        continue;
      }
      const auto [edit, source] = std::prev(at)->second;
      moves.erase(std::prev(at));
      const int last = std::min(move.last, source.last);
      if (source.first < f) moves[source.first] = {edit, {source.first, f - 1, source.from, source.to}};
      if (source.last > last) moves[last + 1] = {edit, {last + 1, source.last, source.from, source.to}};
      if (source.from != move.to) result.push_back({f, last, source.from, move.to});
      f = last + 1;
    }
    return result;
  }

  /// What is left of the first list.
  std::vector<LabelEdit> left(const std::vector<LabelEdit>& edits) const {
    std::vector<LabelEdit> result = edits;
    for (LabelEdit& edit : result) edit.moves.clear();
    for (const auto& [edit, move] : rest_) result[edit].moves.push_back(move);
    for (const auto& [to, moves] : into_)
      for (const auto& [frame, entry] : moves) result[entry.edit].moves.push_back(entry.move);
    std::erase_if(result, [](const LabelEdit& edit) { return edit.moves.empty(); });
    for (LabelEdit& edit : result)
      std::stable_sort(edit.moves.begin(), edit.moves.end(), [](auto& a, auto& b) { return a.first < b.first; });
    return result;
  }

 private:
  struct Entry {
    std::size_t edit;
    LabelMove move;
  };
  std::map<std::string, std::map<int, Entry>> into_;
  std::vector<std::pair<std::size_t, LabelMove>> rest_;
};

}  // namespace

std::vector<LabelEdit> composed(const std::vector<LabelEdit>& first, const std::vector<LabelEdit>& second) {
  FirstMoves moves(first);
  std::vector<LabelEdit> later;
  for (const LabelEdit& edit : second) {
    LabelEdit traced = edit;
    traced.moves.clear();
    for (const LabelMove& move : edit.moves) {
      const std::vector<LabelMove> pieces = edit.applied ? moves.traced(move) : std::vector<LabelMove>();
      traced.moves.insert(traced.moves.end(), pieces.begin(), pieces.end());
    }
    if (!traced.moves.empty()) later.push_back(std::move(traced));
  }
  std::vector<LabelEdit> result = moves.left(first);
  result.insert(result.end(), later.begin(), later.end());
  std::stable_sort(result.begin(), result.end(), [](const auto& a, const auto& b) { return a.first() < b.first(); });
  return result;
}

}  // namespace vultus::mocap
