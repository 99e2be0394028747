#pragma once

#include <filesystem>
#include <vector>

#include "core/manifest.h"
#include "core/progress.h"
#include "render/film.h"
#include "render/path_tracer.h"
#include "render/portrait.h"
#include "retarget/weights.h"
#include "rig/actor.h"

namespace vultus::render {

struct SequenceOptions {
  int first = 0, last = -1;  ///< frames [first, last); last -1: to the end of the take
  int step = 1;              ///< every step-th frame from `first`, ≥ 1
  PortraitOptions portrait;  ///< framed on the neutral and then fixed
  PathTracerOptions tracer;
  std::filesystem::path environment;  ///< lat-long HDR; empty: `Environment::studio`
  double environment_rotation = 0.0;  ///< radians
  double environment_intensity = 1.0;
  bool show_environment = false;        ///< behind the head, instead of a plain backdrop
  ToneCurve curve = ToneCurve::filmic;  ///< of the PNG
  double exposure = 0.0;                ///< stops, of the PNG
  bool force = false;                   ///< render frames that are current, too
};

struct SequenceResult {
  std::vector<std::filesystem::path> frames;  ///< the EXR of every frame asked for, in order; a PNG beside each
  int rendered = 0;                           ///< frames made now; the others were current
  std::uint64_t rays = 0;
};

/// The scene of an actor at rest: geometry, albedo (or `face_look`), finishes, light, camera. Only `positions` changes
/// from frame to frame.
Scene actor_scene(const rig::Actor& actor, const SequenceOptions& options);

/// Path-traces frames of a retargeted take (geometry by Liu et al. 2011 eq. 3) to `folder`/NNNNNN.exr and .png, with
/// NNNNNN.json beside them, a manifest that says how they were made. Each frame stands alone: a second run, or another
/// machine with another range, renders only what is not current. `source` names the inputs (hashes of actor and
/// weights); the options are added here. Throws `UsageError` for a range outside the take, `InputError`, `OutputError`,
/// `Cancelled` (finished frames stay).
SequenceResult render_sequence(const rig::Actor& actor, const retarget::Weights& weights,
                               const std::filesystem::path& folder, const Provenance& source,
                               const SequenceOptions& options, Progress& progress = Progress::none());

}  // namespace vultus::render
