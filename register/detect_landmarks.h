#pragma once

#include <string>
#include <vector>

#include "core/mesh.h"
#include "register/face_finder.h"
#include "register/landmarks.h"

namespace vultus::registration {

/// The 68 points found on a scan without any hand.
struct DetectedLandmarks {
  ScanLandmarks points;  ///< "ibug.0" … "ibug.67" that were found, scan frame, with confidence
  Eigen::Matrix3d scan_from_face = Eigen::Matrix3d::Identity();  ///< columns: the face's right-to-left, up, front axes
  Eigen::VectorXd spread;  ///< per point of `points`, mm: median distance of the views' answers from their consensus
  double score = 0.0;      ///< mean face score of the views used; a clear face has more than 1
  int views = 0;           ///< that took part in the consensus
  double agreement = 0.0;  ///< share of the views around the face in which it was seen, [0, 1]
  int other_faces = 0;     ///< in the scan beside the one that was taken
  bool coloured = false;   ///< colour helped; without it brows are vague
  double outer_eye_distance = 0.0;  ///< between the outer eye corners, scan units; 0 when not found
  std::vector<std::string> decisions;
  std::vector<std::string> doubts;  ///< whether this is a face at all, in words; empty for a clear one
};

/// Finds the face in a scan of unknown orientation (`search_face`) and its 68 points: a fan of views turned about that
/// face; each view's points are cast back to the surface and agree on one place by a robust mean. Throws `InputError`
/// when no view shows a face.
DetectedLandmarks detect_landmarks(const Mesh& scan, const FaceFinder& finder);

}  // namespace vultus::registration
