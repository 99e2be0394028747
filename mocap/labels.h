#pragma once

#include <string>
#include <vector>

#include "mocap/label_edits.h"
#include "mocap/take.h"

namespace vultus::mocap {

struct LabelOptions {
  double jump_mm = 1.5;      ///< steps that straight motion misses by more may change the marker, > 0
  double misfit_mm = 1.5;    ///< a marker nearer than this to where its neighbours put it is left alone, > 0
  double times_usual = 3.5;  ///< and so is one that strays less than this many times its own usual misfit, > 1
  double better = 0.5;       ///< another label must take the misfit down to this share of it, 0…1
  double phantom_mm = 4.0;   ///< a stretch that fits no marker and strays at least this far is a phantom, > 0
  void validate() const;     ///< throws `UsageError`
};

/// A take with its labels repaired.
struct Relabelled {
  Take take;
  LabelEdits edits;
  std::vector<std::string> decisions;
  std::vector<std::string> warnings;  ///< places to look at before the labels are trusted
};

/// Finds samples under wrong labels, unlabelled stretches of markers, and phantoms. Columns are cut into tracklets
/// where the object may have changed; each tracklet is compared with where its marker's neighbours, and the same marker
/// just before and after, put it (in head coordinates from the steadiest markers, so that neither jig nor face is
/// trusted alone). Those that misfit are given the label that fits, clearest first, if it is free. What fits well is
/// never touched. Takes with fewer than eight labelled markers are given back as they are, and `decisions` says so.
Relabelled repair_labels(Take raw, const LabelOptions& options = {});

}  // namespace vultus::mocap
