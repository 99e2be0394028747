#include "mocap/label_edits.h"

#include <algorithm>
#include <map>

#include "core/error.h"
#include "mocap/tracklets.h"

namespace vultus::mocap {

namespace {

struct Sample {
  float position[3];
  float residual = 0.0F;
  std::uint8_t cameras = 0;
};

Sample sample_of(const Take& take, int frame, int column) {
  const std::size_t i = take.index(frame, column);
  Sample sample;
  std::copy_n(take.positions.data() + 3 * i, 3, sample.position);
  if (!take.residuals.empty()) sample.residual = take.residuals[i];
  if (!take.cameras.empty()) sample.cameras = take.cameras[i];
  return sample;
}

void put(Take& take, int frame, int column, const Sample& sample) {
  const std::size_t i = take.index(frame, column);
  take.present[i] = 1;
  std::copy_n(sample.position, 3, take.positions.data() + 3 * i);
  if (!take.residuals.empty()) take.residuals[i] = sample.residual;
  if (!take.cameras.empty()) take.cameras[i] = sample.cameras;
}

/// `take` without samples and with other labels.
Take relabelled(const Take& take, std::vector<std::string> labels) {
  Take result = Take::empty(take.name, take.rate_hz, std::move(labels), take.frames());
  result.residual_step = take.residual_step;
  result.first_frame = take.first_frame;
  result.events = take.events;
  result.decisions = take.decisions;
  if (!take.residuals.empty()) result.residuals.assign(result.present.size(), 0.0F);
  if (!take.cameras.empty()) result.cameras.assign(result.present.size(), 0);
  return result;
}

[[noreturn]] void refuse(const Take& take, const LabelMove& move, const std::string& problem) {
  throw InputError("take '" + take.name + "', label edit of frames " + std::to_string(move.first) + " to " +
                   std::to_string(move.last) + ", '" + move.from + "' → '" + move.to + "': " + problem);
}

/// Where each sample of the raw take goes: a column of `labels`, or -1 for dropped.
std::vector<int> targets(const Take& raw, const LabelEdits& edits, std::vector<std::string>& labels) {
  std::vector<int> target(raw.present.size());
  for (int f = 0; f < raw.frames(); ++f) {
    for (int c = 0; c < raw.markers(); ++c) target[raw.index(f, c)] = c;
  }
  labels = raw.labels;
  std::vector<std::uint8_t> moved(raw.present.size(), 0);
  for (const LabelEdit& edit : edits.edits) {
    for (const LabelMove& move : edit.moves) {
      const int from = raw.find(move.from);
      if (from < 0) refuse(raw, move, "the take has no such column");
      if (move.first < 0 || move.last < move.first || move.last >= raw.frames()) refuse(raw, move, "no such frames");
      if (!edit.applied) continue;
      auto to = std::find(labels.begin(), labels.end(), move.to) - labels.begin();
      if (!move.to.empty() && to == static_cast<std::ptrdiff_t>(labels.size())) labels.push_back(move.to);
      for (int f = move.first; f <= move.last; ++f) {
        if (!raw.has(f, from)) refuse(raw, move, "there is no sample in frame " + std::to_string(f));
        if (moved[raw.index(f, from)]++) refuse(raw, move, "another edit moves frame " + std::to_string(f) + " too");
        target[raw.index(f, from)] = move.to.empty() ? -1 : static_cast<int>(to);
      }
    }
  }
  return target;
}

/// Unlabelled columns that no sample ends in are left out of `labels`; the others keep their order.
std::vector<int> compacted(const Take& raw, const std::vector<int>& target, std::vector<std::string>& labels) {
  std::vector<std::uint8_t> used(labels.size(), 0);
  for (std::size_t i = 0; i < target.size(); ++i) {
    if (raw.present[i] && target[i] >= 0) used[static_cast<std::size_t>(target[i])] = 1;
  }
  std::vector<int> place(labels.size(), -1);
  std::vector<std::string> kept;
  for (std::size_t c = 0; c < labels.size(); ++c) {
    if (!used[c] && is_unlabelled(labels[c])) continue;
    place[c] = static_cast<int>(kept.size());
    kept.push_back(labels[c]);
  }
  labels = std::move(kept);
  return place;
}

}  // namespace

std::string name_of(LabelEdit::Kind kind) {
  switch (kind) {
    case LabelEdit::Kind::swap:
      return "swap";
    case LabelEdit::Kind::moved:
      return "moved";
    case LabelEdit::Kind::fragment:
      return "fragment";
    case LabelEdit::Kind::phantom:
      break;
  }
  return "phantom";
}

int LabelEdit::first() const {
  const auto least = std::min_element(moves.begin(), moves.end(), [](auto& a, auto& b) { return a.first < b.first; });
  return least == moves.end() ? 0 : least->first;
}

int LabelEdit::last() const {
  const auto most = std::max_element(moves.begin(), moves.end(), [](auto& a, auto& b) { return a.last < b.last; });
  return most == moves.end() ? 0 : most->last;
}

Take apply_edits(const Take& raw, LabelEdits& edits) {
  edits.take = raw.name;
  edits.labels = raw.labels;
  edits.dropped.clear();
  std::vector<std::string> labels;
  const std::vector<int> target = targets(raw, edits, labels);
  const std::vector<int> place = compacted(raw, target, labels);
  Take result = relabelled(raw, std::move(labels));
  for (int f = 0; f < raw.frames(); ++f) {
    for (int c = 0; c < raw.markers(); ++c) {
      if (!raw.has(f, c)) continue;
      const Sample sample = sample_of(raw, f, c);
      const int to = target[raw.index(f, c)];
      if (to < 0) {
        LabelEdits::Dropped& d = edits.dropped.emplace_back();
        d.column = raw.labels[static_cast<std::size_t>(c)];
        d.frame = f;
        std::copy_n(sample.position, 3, d.position);
        d.residual = sample.residual;
        d.cameras = sample.cameras;
        continue;
      }
      const int column = place[static_cast<std::size_t>(to)];
      if (result.has(f, column)) {
        throw InputError("take '" + raw.name + "', frame " + std::to_string(f) +
                         ": the label edits put two samples under '" + result.labels[static_cast<std::size_t>(column)] +
                         "'");
      }
      put(result, f, column, sample);
    }
  }
  return result;
}

Take undo_edits(const Take& edited, const LabelEdits& edits) {
  Take raw = relabelled(edited, edits.labels);
  // Where a sample of the edited take came from: its own column, unless a move says otherwise.
  std::vector<int> source(edited.present.size());
  for (int f = 0; f < edited.frames(); ++f) {
    for (int c = 0; c < edited.markers(); ++c) {
      source[edited.index(f, c)] = raw.find(edited.labels[static_cast<std::size_t>(c)]);
    }
  }
  for (const LabelEdit& edit : edits.edits) {
    if (!edit.applied) continue;
    for (const LabelMove& move : edit.moves) {
      if (raw.find(move.from) < 0) refuse(edited, move, "the list has no such column");
      if (move.first < 0 || move.last < move.first || move.last >= edited.frames())
        refuse(edited, move, "no such frames");
      const int to = move.to.empty() ? -1 : edited.find(move.to);
      for (int f = move.first; to >= 0 && f <= move.last; ++f) source[edited.index(f, to)] = raw.find(move.from);
    }
  }
  for (int f = 0; f < edited.frames(); ++f) {
    for (int c = 0; c < edited.markers(); ++c) {
      if (!edited.has(f, c)) continue;
      const int column = source[edited.index(f, c)];
      if (column < 0)
        throw InputError("take '" + edited.name + "': the edits do not say where column '" +
                         edited.labels[static_cast<std::size_t>(c)] + "' came from");
      put(raw, f, column, sample_of(edited, f, c));
    }
  }
  for (const LabelEdits::Dropped& d : edits.dropped) {
    const int column = raw.find(d.column);
    if (column < 0 || d.frame < 0 || d.frame >= raw.frames()) {
      throw InputError("take '" + edited.name + "': the edits restore a sample of '" + d.column + "' in frame " +
                       std::to_string(d.frame) + ", which the take does not have");
    }
    put(raw, d.frame, column, {{d.position[0], d.position[1], d.position[2]}, d.residual, d.cameras});
  }
  return raw;
}

}  // namespace vultus::mocap
