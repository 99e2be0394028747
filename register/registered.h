#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "core/transform.h"
#include "register/landmarks.h"
#include "register/quality.h"

namespace vultus::registration {

class Appearance;

/// A landmark that took part.
struct UsedLandmark {
  std::string name;
  Eigen::Vector3d on_scan, on_mesh;  ///< face frame, mm
  double confidence = 0.0;           ///< [0, 1]
  double residual = 0.0;             ///< mm between both
};

/// A scan in the template's topology.
struct Registered {
  Mesh mesh;                  ///< refined topology, face frame, mm
  Similarity face_from_scan;  ///< of the cleaned scan; scale is 1 unless the scan's unit proved wrong
  std::vector<UsedLandmark> landmarks;
  ScanLandmarks detected;  ///< every landmark found or given, face frame
  bool coloured = false;   ///< landmarks were found with the help of colour
  std::shared_ptr<const Appearance> look;  ///< of a neutral's scan, by the methods that compare looks; else null
  Points on_look;                          ///< `mesh` in the frame of that scan, mm
  Quality quality;
  std::vector<std::string> decisions;  ///< what was decided about the input, in words
};

}  // namespace vultus::registration
