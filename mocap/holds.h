#pragma once

#include <utility>
#include <vector>

#include "core/mesh.h"
#include "mocap/take.h"

namespace vultus::mocap {

/// RMS speed of the tenth of the markers (three at least) that moves most, of a take in head coordinates, mm/s,
/// smoothed over 0.1 s; one a frame, NaN where too few markers are seen.
std::vector<double> face_speeds(const Take& clean);

/// The frames around `frame`, at most `reach` to either side, over which the face is about as still as at `frame`.
std::pair<int, int> still_around(const std::vector<double>& speeds, int frame, int reach);

/// Component-wise median position of each marker over the frames (first, last); NaN for markers never seen.
Points mean_pose(const Take& clean, std::pair<int, int> frames);

/// RMS distance of the samples in the frames from `pose`, mm.
double spread_about(const Take& clean, std::pair<int, int> frames, const Points& pose);

/// RMS distance over the tenth (three at least) of the markers seen in both that are farthest apart, so that a pose of
/// the lids counts as much as one of the jaw; infinite when there are none.
double pose_distance(const Points& a, const Points& b);

struct NeutralChoice {
  Points pose;               ///< over all rests of the neutral
  std::pair<int, int> hold;  ///< its longest rest
  double score = 0.0;        ///< share of the rests that are neutral
};

/// The rest that recurs most (rests within `tolerance` mm of each other are one; ties go to the earlier).
NeutralChoice choose_neutral(const Take& clean, const std::vector<std::pair<int, int>>& holds, double tolerance);

}  // namespace vultus::mocap
