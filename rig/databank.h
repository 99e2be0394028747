#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/progress.h"
#include "register/template.h"
#include "rig/actor.h"

namespace vultus::rig {

/// Expressions of one neutral head, to be brought to others by motion transfer; with what else the source offers.
struct Databank {
  Actor actor;                         ///< neutral and expressions
  registration::Template head;         ///< the same topology as a template for registration
  std::vector<Pose> identities;        ///< neutral heads of other shapes
  std::vector<std::string> decisions;  ///< what reading decided (units, frame, skipped files), for the report
};

/// Reads a folder of ICT-FaceKit's light model: `generic_neutral_mesh.obj`, `vertex_indices.json`, the expressions it
/// lists (and any other expression beside them) and `identity*.obj`.
/// - Units are decided by the distance of the outer eye corners; the frame becomes DESIGN §1's.
/// - Listed expressions without a file are reported and left out; a damaged one is an `InputError`.
/// - Poses are tagged with ARKit names ("browDown_L" → "browDownLeft") and FACS units.
/// - `mouthClose` closes the lips of an open jaw and is no face by itself: it becomes neutral + jawOpen + mouthClose.
/// - The model's texture tiles share one unit square; they are laid side by side, the face in [0, ¾]², so that a texel
///   belongs to one part only.
/// - Vertex sets: `face`, `face_narrow`, `head_neck`, `skin` (both), `rigid`, `lips`, `upper_lip`, `lower_lip`, `lids`,
///   `lids_left`, `lids_right`, `eyeballs` and `eyeball_…`, `sclera_…`, `iris_…`, `eye_socket_…`, `lacrimal_…`,
///   `eye_blend_…`, `eye_occlusion_…`, `eyelashes_…` (each `left` and `right`), `mouth_cavity`, `gums_tongue`, `teeth`,
///   `teeth_upper`, `teeth_lower`, `hidden` (what no scanner sees).
/// Left is the subject's. Throws `InputError` for another topology.
Databank read_ict_facekit(const std::filesystem::path& folder, Progress& progress = Progress::none());

/// Reads `ict_folder` and writes `out` as an actor folder that also has `template.obj`/`template.json` and
/// `identities/<name>.ply`. Files that are current are left alone. Returns what was decided.
std::vector<std::string> import_ict_facekit(const std::filesystem::path& ict_folder, const std::filesystem::path& out,
                                            Progress& progress = Progress::none(), bool force = false);

/// The neutral heads of other shapes that a databank folder holds, verified.
std::vector<Pose> load_identities(const std::filesystem::path& databank_folder);

}  // namespace vultus::rig
