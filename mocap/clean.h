#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.h"
#include "mocap/filter.h"
#include "mocap/gaps.h"
#include "mocap/labels.h"
#include "mocap/local_frames.h"
#include "mocap/repeats.h"
#include "mocap/spikes.h"
#include "mocap/stabilize.h"

namespace vultus::mocap {

struct CleanOptions {
  LabelOptions labels;
  bool repair_labels = true;
  std::optional<LabelEdits> label_edits;  ///< a list that was looked through by hand: it is applied, nothing is sought
  std::optional<RigidBody> layout;        ///< of `marker_layout`: labels for a take with fewer than eight
  StabilizeOptions head;
  SpikeOptions spikes;
  FillOptions gaps;
  std::vector<VirtualMarker> virtual_markers;  ///< never captured, carried by their siblings
  FilterOptions filter;
  bool remove_spikes = true;
  bool keep_measured = false;  ///< fill `Cleaned::measured`
  void validate() const;       ///< throws `UsageError`
};

/// A repeat with its marker's name: that marker may not be in the cleaned take.
struct RepeatNote {
  Repeat::Kind kind = Repeat::Kind::held;
  std::string marker;       ///< empty for whole frames
  int first = 0, last = 0;  ///< frames as read, before doubled ones were taken out
};

/// What cleaning found and did, the content of samples.json.
struct CleanReport {
  std::string take, head_method;
  double rate_hz = 0.0;
  std::vector<int> file_frames;  ///< of the cleaned take, see `Take::file_frames`
  std::vector<std::string> labels;
  std::vector<double> missing;  ///< per marker, share of the frames as captured, 0…1
  std::vector<Gap> gaps;
  std::vector<Spike> spikes;
  std::vector<RepeatNote> repeats;
  std::vector<LabelEdit> label_edits;  ///< refused ones too; frames as read, before doubled ones were taken out
  std::vector<JigSlip> slips;
  std::vector<std::string> head_markers;
  std::vector<double> head_deviations;  ///< mm, one a head marker
  std::vector<double> head_residuals;   ///< mm RMS, one a frame; NaN without a measured pose
  double head_rms = 0.0;                ///< mm
  std::vector<std::string> decisions;   ///< of reading and of every step
  std::vector<std::string> warnings;    ///< what to look at before the take is trusted
  std::vector<Origin> origins;          ///< frames × markers
  std::vector<float> expected_errors;   ///< frames × markers, mm
};

struct Cleaned {
  Take take;                    ///< head coordinates, without jig markers
  Take measured;                ///< the same as measured, when asked for: nothing taken out, filled or smoothed
  RigidBody body;               ///< hand it to the other takes of the session, so that all share head coordinates
  std::vector<HeadPose> poses;  ///< one a frame
  CleanReport report;
  LabelEdits label_edits;  ///< what was done to the labels of the raw take; undone by `undo_edits`
};

/// The chain of DESIGN §3.4: labels repaired, head motion out, spikes out, gaps filled, never-captured markers added,
/// smoothed. Deterministic. Hand the take over (`std::move`) to spare the memory of a copy. Throws `InputError`,
/// `Cancelled`.
Cleaned clean(Take raw, const CleanOptions& options = {}, Progress& progress = Progress::none());

/// samples.json: the report, the origin of every sample that was not measured in run-length form.
void write_samples(const std::filesystem::path& file, const CleanReport& report);
/// Throws `InputError` for anything malformed.
CleanReport read_samples(const std::filesystem::path& file);

/// "measured", "spline", "rigid_group", …
std::string name_of(Origin origin);

}  // namespace vultus::mocap
