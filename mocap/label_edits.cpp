#include "mocap/label_edits.h"

#include <algorithm>
#include <map>

#include "core/error.h"
#include "mocap/take_parts.h"
#include "mocap/tracklets.h"

namespace vultus::mocap {

namespace {

struct Sample {
  float position[3] = {0.0F, 0.0F, 0.0F};
  float residual = 0.0F;
  std::uint8_t cameras = 0;
};

Sample sample_at(const Take& take, std::size_t i) {
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

[[noreturn]] void refuse(const Take& take, const LabelMove& move, const std::string& problem) {
  throw InputError("take '" + take.name + "', label edit of frames " + std::to_string(move.first) + " to " +
                   std::to_string(move.last) + ", '" + move.from + "' → '" + move.to + "': " + problem);
}

/// A sample that changes its column.
struct Moved {
  std::size_t index;  // in the raw take
  int from, to;       // columns, -1: dropped
};

/// The samples that move, by index; what only the edits name is added to `labels`.
std::vector<Moved> moved_samples(const Take& raw, const LabelEdits& edits, std::vector<std::string>& labels) {
  std::vector<Moved> moved;
  for (const LabelEdit& edit : edits.edits) {
    for (const LabelMove& move : edit.moves) {
      const int from = raw.find(move.from);
      if (from < 0) refuse(raw, move, "the take has no such column");
      if (move.first < 0 || move.last < move.first || move.last >= raw.frames()) refuse(raw, move, "no such frames");
      if (!edit.applied) continue;
      const auto to = std::find(labels.begin(), labels.end(), move.to) - labels.begin();
      if (!move.to.empty() && to == static_cast<std::ptrdiff_t>(labels.size())) labels.push_back(move.to);
      for (int f = move.first; f <= move.last; ++f) {
        if (!raw.has(f, from)) refuse(raw, move, "there is no sample in frame " + std::to_string(f));
        moved.push_back({raw.index(f, from), from, move.to.empty() ? -1 : static_cast<int>(to)});
      }
    }
  }
  std::sort(moved.begin(), moved.end(), [](const Moved& a, const Moved& b) { return a.index < b.index; });
  const auto twice =
      std::adjacent_find(moved.begin(), moved.end(), [](const Moved& a, const Moved& b) { return a.index == b.index; });
  if (twice == moved.end()) return moved;
  throw InputError("take '" + raw.name + "', frame " + std::to_string(twice->index / raw.labels.size()) +
                   ": two label edits move the sample of '" + labels[static_cast<std::size_t>(twice->from)] + "'");
}

/// Unlabelled columns that no sample ends in are left out of `labels`; the others keep their order.
std::vector<int> compacted(const Take& raw, const std::vector<Moved>& moved, std::vector<std::string>& labels) {
  std::vector<std::ptrdiff_t> samples(labels.size(), 0);
  for (int f = 0; f < raw.frames(); ++f)
    for (int c = 0; c < raw.markers(); ++c) samples[static_cast<std::size_t>(c)] += raw.has(f, c);
  for (const Moved& m : moved) {
    --samples[static_cast<std::size_t>(m.from)];
    if (m.to >= 0) ++samples[static_cast<std::size_t>(m.to)];
  }
  std::vector<int> place(labels.size(), -1);
  std::vector<std::string> kept;
  for (std::size_t c = 0; c < labels.size(); ++c) {
    if (samples[c] == 0 && is_unlabelled(labels[c])) continue;
    place[c] = static_cast<int>(kept.size());
    kept.push_back(labels[c]);
  }
  labels = std::move(kept);
  return place;
}

/// Gives a take other columns, frame by frame in its own memory.
class InPlace {
 public:
  InPlace(Take& take, std::vector<std::string> labels) : take_(take), old_(take.labels.size()), frames_(take.frames()) {
    take.labels = std::move(labels);
    row_.resize(old_);
    fit(std::max(old_, take.labels.size()));
  }

  /// `put_row(frame, samples, present)` writes the samples of one frame to their new places.
  template <class PutRow>
  void each_frame(const PutRow& put_row) {
    const bool wider = take_.labels.size() > old_;  // then the last frames make room for those before
    std::vector<std::uint8_t> present(old_);
    for (int k = 0; k < frames_; ++k) {
      const int f = wider ? frames_ - 1 - k : k;
      for (std::size_t c = 0; c < old_; ++c) {
        const std::size_t i = static_cast<std::size_t>(f) * old_ + c;
        present[c] = take_.present[i];
        row_[c] = sample_at(take_, i);
      }
      for (int c = 0; c < take_.markers(); ++c) {
        put(take_, f, c, {});
        take_.drop(f, c);
      }
      put_row(f, row_, present);
    }
    fit(take_.labels.size());
  }

 private:
  void fit(std::size_t columns) {
    const std::size_t samples = static_cast<std::size_t>(frames_) * columns;
    take_.positions.resize(3 * samples);
    take_.present.resize(samples);
    if (!take_.residuals.empty()) take_.residuals.resize(samples);
    if (!take_.cameras.empty()) take_.cameras.resize(samples);
  }

  Take& take_;
  std::size_t old_;
  int frames_;
  std::vector<Sample> row_;
};

}  // namespace

int LabelEdit::first() const {
  const auto least = std::min_element(moves.begin(), moves.end(), [](auto& a, auto& b) { return a.first < b.first; });
  return least == moves.end() ? 0 : least->first;
}

int LabelEdit::last() const {
  const auto most = std::max_element(moves.begin(), moves.end(), [](auto& a, auto& b) { return a.last < b.last; });
  return most == moves.end() ? 0 : most->last;
}

std::string LabelEdit::sources() const {
  std::vector<std::string> labels;
  for (const LabelMove& move : moves)
    if (std::ranges::find(labels, move.from) == labels.end()) labels.push_back(move.from);
  std::string text;
  for (const std::string& label : labels) text += (text.empty() ? "" : ", ") + label;
  return text;
}

std::vector<std::string> list_notes(const LabelEdits& edits) {
  const auto made = std::ranges::count_if(edits.edits, &LabelEdit::applied);
  std::vector<std::string> notes = {"labels: " + std::to_string(made) + (made == 1 ? " change" : " changes") +
                                    " made by the given list"};
  for (const LabelEdit& edit : edits.edits) {
    if (edit.applied) continue;
    notes.push_back("labels: " + name_of(edit.kind) + " at frame " + std::to_string(edit.first()) +
                    " refused in the list; the samples stay under " + edit.sources());
  }
  return notes;
}

Take apply_edits(Take take, LabelEdits& edits) {
  edits.take = take.name;
  edits.labels = take.labels;
  edits.dropped.clear();
  std::vector<std::string> labels = take.labels;
  const std::vector<Moved> moved = moved_samples(take, edits, labels);
  const std::vector<int> place = compacted(take, moved, labels);
  if (moved.empty() && labels == take.labels) return take;
  InPlace relabelled(take, std::move(labels));
  relabelled.each_frame([&](int f, const std::vector<Sample>& samples, const std::vector<std::uint8_t>& present) {
    const std::size_t first = static_cast<std::size_t>(f) * samples.size();
    auto next = std::lower_bound(moved.begin(), moved.end(), first,
                                 [](const Moved& m, std::size_t index) { return m.index < index; });
    for (std::size_t c = 0; c < samples.size(); ++c) {
      const bool moves = next != moved.end() && next->index == first + c;
      const int to = moves ? (next++)->to : static_cast<int>(c);
      if (present[c] == 0) continue;
      if (to < 0) {
        const Sample& s = samples[c];
        edits.dropped.push_back(
            {edits.labels[c], f, {s.position[0], s.position[1], s.position[2]}, s.residual, s.cameras});
        continue;
      }
      const int column = place[static_cast<std::size_t>(to)];
      if (take.has(f, column)) {
        throw InputError("take '" + take.name + "', frame " + std::to_string(f) +
                         ": the label edits put two samples under '" + take.labels[static_cast<std::size_t>(column)] +
                         "'");
      }
      put(take, f, column, samples[c]);
    }
  });
  std::stable_sort(edits.dropped.begin(), edits.dropped.end(),
                   [](const auto& a, const auto& b) { return a.frame < b.frame; });
  return take;
}

Take undo_edits(const Take& edited, const LabelEdits& edits) {
  Take raw = emptied(edited, edits.labels);
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
      copy_sample(edited, edited.index(f, c), raw, raw.index(f, column));
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
