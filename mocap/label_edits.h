#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "mocap/take.h"

namespace vultus::mocap {

/// Samples of one column that belong under another label.
struct LabelMove {
  int first = 0, last = 0;  ///< frames, both ends
  std::string from, to;     ///< labels; `to` empty: dropped
};

/// One change of labels; its moves stand or fall together.
struct LabelEdit {
  enum class Kind : std::uint8_t {
    swap,      ///< markers under each other's labels
    moved,     ///< a marker under the label of another that is not there
    fragment,  ///< an unlabelled stretch that belongs to a marker
    phantom,   ///< no marker: dropped
  } kind = Kind::swap;
  std::vector<LabelMove> moves;
  double score = 0.0;   ///< 0…1: the share of the misfit that the change takes away
  std::string why;      ///< the misfits before and after, in mm
  bool applied = true;  ///< false: refused by hand

  int first() const;
  int last() const;
  std::string sources() const;  ///< the labels that its samples came with, "LIP1, *12"; they keep them when refused
};

/// Every change made to a take's labels, with all that is needed to take it back.
struct LabelEdits {
  std::string take;
  std::vector<std::string> labels;  ///< the take's columns as they came, in order
  std::vector<LabelEdit> edits;     ///< in order of their first frames
  struct Dropped {
    std::string column;
    int frame = 0;
    float position[3] = {0, 0, 0}, residual = 0.0F;
    std::uint8_t cameras = 0;
  };
  std::vector<Dropped> dropped;  ///< samples that no longer stand in the edited take
};

/// The take with the edits that are `applied`, all at once; `edits.dropped` is filled. Unlabelled columns (see
/// `is_unlabelled`) that end up empty are left out; labels that only the edits name are appended. Throws `InputError`
/// when a move names an unknown column or a frame without a sample, or two samples end under one label.
Take apply_edits(Take raw, LabelEdits& edits);

/// The take as it came: positions, residuals and camera masks of every sample. Throws `InputError` when the take does
/// not match.
Take undo_edits(const Take& edited, const LabelEdits& edits);

/// For the report: how many edits were made, how many refused, and under which labels the samples of those stay.
std::vector<std::string> list_notes(const LabelEdits& edits);

/// JSON (DESIGN §2, labels.json). Reading throws `InputError` naming the entry that is malformed.
void write_edits(const std::filesystem::path& file, const LabelEdits& edits);
LabelEdits read_edits(const std::filesystem::path& file);

std::string name_of(LabelEdit::Kind kind);  ///< "swap", "moved", "fragment", "phantom"

}  // namespace vultus::mocap
