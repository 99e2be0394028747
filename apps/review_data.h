#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "mocap/clean.h"
#include "retarget/errors.h"
#include "retarget/weights.h"
#include "rig/actor.h"

namespace vultus::apps {

// What the review page reads from disk, beside what DESIGN §2 lists. Every file is optional: a part without its files
// is left out of the page and named in "where to look". Unknown keys are ignored, null stands for "not measured".
//
// ACTOR/report/registration.json   written by `onboard` (and `register`):
//   {"template": NAME, "method": "default|zhu|sanchez", "decisions": [TEXT…], "warnings": [TEXT…],
//    "poses": [{"pose": NAME, "source": "scan" | "transfer", "scan": PATH, "verdict": "pass" | "warn" | "fail",
//               "reason": TEXT,                          why not pass; several joined by "; "
//               "distance_mm": {"mean": x, "rms": x, "p95": x, "max": x},     scan to mesh, in the face
//               "coverage": 0…1,                         share of the face that has scan beside it
//               "reasons": [TEXT…], "cleaning": [TEXT…],   the same one by one; what was done to the scan
//               "landmark_rms_mm": x, "flipped_triangles": n, "stretched_triangles": n, "crossing_triangles": n,
//               "crumpled_triangles": n,
//               "regions": {"lips": {"mean": x, "p95": x, "coverage": 0…1, "flipped": n, "stretched": n,
//                                    "crossing": n, "crumpled": n}, …},   scan to mesh, mm
//               "seals": [{"name": "lips", "mesh_mm": x, "scan_mm": x or null}…],   openings of lips and lids
//               "regions_mm": {"lips": x, …},            mean distance in a vertex set
//               "picture": "report/<pose>.png"}]}        relative to ACTOR
// ACTOR/report/<pose>.distance.npy  float32, vertex_count: distance of each vertex to the scan, mm; NaN where no scan
//                                   is near.
// SESSION/session.json facts: {"actor": PATH (absolute or relative to SESSION), "takes": [NAME…], "solver": NAME,
//                              "decisions": [TEXT…], "warnings": [TEXT…]}; a session's own regions replace the actor's
//                              (apps/session_actor.h).
// SESSION/markers.json             rig/markers.h: where the session's markers sit on the rig; else the actor's own.
// SESSION/takes/<take>/report.json  written by `session`:
//   {"space": "training" | "surface",                    where the marker basis came from, so what the errors measure
//    "decisions": [TEXT…], "warnings": [TEXT…],
//    "table": [{"regions": n, "name": TEXT, "max_mm": x, "min_mm": x, "mean_mm": x}…],     Liu's table 1, global first
//    "solve": {"worst_kkt_residual": x}}
// SESSION/takes/<take>/errors_global.csv   the form of errors.csv, for the global solve.
// SESSION/takes/<take>/samples.json       mocap/clean.h: gaps, spikes, head residuals, warnings.
// SESSION/takes/<take>/{measured,clean}.c3d  head coordinates, before anything was taken out, filled or smoothed, and
//                                            after.
// SESSION/render/<take>/<frame>.{png,jpg}   also in realtime/ and reference/ below <take>.
// SESSION/render/<take>/film.mp4    (or any .mp4 there) inlined below 8 MB, else linked.

/// One take of a session as far as it is on disk.
struct ReviewTake {
  std::string name;
  std::optional<retarget::Weights> weights;
  std::optional<retarget::MarkerErrors> errors, global_errors;
  std::optional<mocap::CleanReport> samples;
  std::optional<mocap::Take> measured, clean;  ///< both or neither
  nlohmann::json report = nlohmann::json::object();
  double rate_hz() const;
  int frames() const;
};

/// A session folder and its actor.
struct ReviewSession {
  std::filesystem::path folder, actor_folder;
  rig::Actor actor;
  nlohmann::json facts, registration;  ///< session.json's facts; null without a registration report
  std::map<std::string, SurfacePoint> markers;
  std::vector<ReviewTake> takes;
  std::vector<std::string> missing;           ///< files a whole page would have
  std::map<std::string, std::string> hashes;  ///< artefact → SHA-256, for the provenance line
};

/// Reads everything; throws `InputError` for a folder that is no session, an actor that cannot be loaded, or a file
/// that is there but damaged.
ReviewSession read_review_session(const std::filesystem::path& session);

}  // namespace vultus::apps
