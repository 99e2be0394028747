#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/array_io.h"
#include "mocap/take.h"
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
//               "landmark_rms_mm": x, "flipped_triangles": n, "stretched_triangles": n,
//               "regions_mm": {"lips": x, …},            mean distance in a vertex set
//               "picture": "report/<pose>.png"}]}        relative to ACTOR
// ACTOR/report/<pose>.distance.npy  float32, vertex_count: distance of each vertex to the scan, mm; NaN where no scan
//                                   is near.
// SESSION/session.json facts: {"actor": PATH (absolute or relative to SESSION), "takes": [NAME…], "regions": [NAME…],
//                              "solver": NAME, "decisions": [TEXT…], "warnings": [TEXT…]}
// SESSION/takes/<take>/report.json  written by `session`:
//   {"space": "training" | "surface",                    where the marker basis came from, so what the errors measure
//    "decisions": [TEXT…], "warnings": [TEXT…],
//    "table": [{"regions": n, "name": TEXT, "max_mm": x, "min_mm": x, "mean_mm": x}…],     Liu's table 1, global first
//    "global_errors": "errors_global.csv",               errors.csv's form for the global solve
//    "stabilization": {"method": TEXT, "rms_mm": [x per frame]},
//    "solve": {"frames_per_second": x, "worst_kkt_residual": x}}
// SESSION/takes/<take>/samples.json  mocap/clean.h: how each filled sample came to be.
// SESSION/render/<take>/<frame>.{png,jpg}   also in realtime/ and reference/ below <take>; EXR beside it is not inlined.
// SESSION/render/<take>/film.mp4    copied into the page only below 8 MB, else linked.

}  // namespace vultus::apps
