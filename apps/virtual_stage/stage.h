#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/virtual_stage/virtual_actor.h"
#include "core/progress.h"

namespace vultus::virtual_stage {

struct StageOptions {
  std::uint64_t seed = 1;                 ///< who the actors are, how they hold their heads, all noise
  std::vector<std::string> poses;         ///< of `expression_database()`; empty: all 22. "neutral" is always scanned
  int scan_triangles = 220'000;           ///< each, 1,000 … 10,000,000
  double scan_noise = 0.07;               ///< mm along the ray, 0 … 5
  bool clutter = true;                    ///< hair, shoulders, stand, flying points in the scans
  bool landmarks = false;                 ///< also write landmarks/<pose>.json, as a person would click the major ones
  std::vector<std::string> performances;  ///< of `performance_names()`; empty: all
  double performance_seconds = 8.0;       ///< each, 1 … 600
  double hold_seconds = 1.0;              ///< of each pose in the training take, 0.2 … 10
  double marker_noise = 0.1;              ///< mm, each coordinate, 0 … 10
  double marker_missing = 0.02;           ///< share of the face markers' samples, 0 … 0.5
  double faults = 0.0;                    ///< in every take, times as many as a tracker usually leaves, 0 … 20
  bool mocap = true;                      ///< false: scans only

  void validate() const;  ///< throws `UsageError` or, for an unknown pose or performance, `InputError`
};

/// Makes in `folder` what a studio would bring (capture/, DESIGN §2) and the answer to it (truth/):
///
///     capture/capture.json                 poses with scan and tags
///     capture/scans/<pose>.ply             raw scans of the scanned actor
///     capture/landmarks/<pose>.json        when asked: major landmarks, 1 mm off
///     capture/mocap/<take>.c3d             training and performances of another actor
///     capture/mocap/{training,markers}.json
///     truth/truth.json                     options, seeds, names of the activation channels, head pose of every scan
///     truth/poses/<pose>.ply               true surface (the template subdivided twice), face frame, mm
///     truth/scans/<pose>.ply               the same in the scan's frame
///     truth/albedo.exr                     of the scanned actor, on the template's UVs
///     truth/mocap/poses/<pose>.ply         the mocap actor, as truth/poses
///     truth/mocap/<take>/clean.c3d         markers without head motion, noise or gaps, face frame
///     truth/mocap/<take>/activations.npy   frames × channels
///     truth/mocap/<take>/head_poses.npy    frames × 3 × 4, volume from face
///     truth/mocap/<take>/{faults.json,owners.npy,recorded.c3d}   with `faults`: see fault_truth.h
///
/// A folder simulated twice with the same options holds the same bytes. Throws `OutputError`.
void simulate(const std::filesystem::path& folder, const StageOptions& options, Progress& progress);

/// The actor whom `simulate` puts before the scanner.
VirtualActor scanned_actor(const registration::Template& head, const StageOptions& options);

/// One pose before the scanner and what came of it.
struct StagedScan {
  ScanSubject subject;  ///< the true surface, face frame; its first vertices are the face model's
  Scan scan;
};
/// The scan that `simulate` writes as capture/scans/<pose>.ply, whichever other poses it was asked for. Throws
/// `InputError` for an unknown pose.
StagedScan stage_scan(const VisibleActor& visible, const std::string& pose, const StageOptions& options);

}  // namespace vultus::virtual_stage
