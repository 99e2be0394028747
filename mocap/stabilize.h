#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mocap/jig_slip.h"
#include "mocap/rigid_body.h"
#include "mocap/take.h"

namespace vultus::mocap {

enum class HeadMethod {
  automatic,    ///< jig where there is one, else steady_face
  jig,          ///< robust least squares on the jig markers
  steady_face,  ///< the same on the steadiest face markers, found in the take
  three_point,  ///< the local frame of three jig markers (Zhu 2006 §6.1)
};

struct StabilizeOptions {
  HeadMethod method = HeadMethod::automatic;
  std::vector<std::string> jig;      ///< labels; empty: those that look like a jig's ("jig…", LFHD, headband…)
  std::string nose_tip;              ///< label: the translation of each frame comes from this marker (Zhu 2006 §6.1)
  int reference_frame = -1;          ///< whose head coordinates are used; -1: the most central complete frame
  std::optional<RigidBody> body;     ///< of another take of the same session: its head coordinates are then used
  double interpolate_seconds = 0.2;  ///< frames without a pose are interpolated over gaps up to this long, ≥ 0
  bool find_slips = true;            ///< jig: markers that move on it are found and left out from then on…
  bool reuse_slipped = true;         ///< …and measured anew where they come to rest, once each
  SlipOptions slips;
  bool smooth = true;     ///< the markers' noise is taken out of the head's path; never with three_point
  void validate() const;  ///< throws `UsageError`
};

/// A take in head coordinates.
struct Stabilized {
  Take take;                    ///< without the jig's markers; frames without a pose are missing throughout
  RigidBody body;               ///< markers that stand for the head, in head coordinates
  std::vector<HeadPose> poses;  ///< one a frame
  HeadMethod method = HeadMethod::jig;
  std::vector<JigSlip> slips;  ///< in order of frames
  int reference_frame = 0;
  double rms = 0.0;  ///< over the measured frames, mm
  std::vector<std::string> decisions;
};

/// Takes the head's motion out: every sample in the coordinates that the head had in the reference frame. Throws
/// `InputError` when the take has too few markers for the method or a label is not in it.
Stabilized stabilize(Take take, const StabilizeOptions& options = {});

/// Labels that look like a head jig's.
std::vector<std::string> jig_labels(const std::vector<std::string>& labels);

}  // namespace vultus::mocap
