#pragma once

#include <string>
#include <vector>

#include "register/face_view.h"

namespace vultus::registration {

/// Where the face of a scan is, and who else is there.
struct FaceSearch {
  FacePlace place;
  double score = 0.0;             ///< of the face finder, seen close and straight on
  std::string how;                ///< in which turn it was found, in words
  std::vector<FacePlace> others;  ///< faces elsewhere in the scan, of comparable size
};

/// Finds the face in a scan of unknown orientation, unit and position: upright pictures first, then small ones from
/// directions all around in all rolls; candidates are looked at closely, best first, until one is surely a face. Then
/// the surface outside that head is searched for more faces. Throws `InputError` when nothing is a face.
FaceSearch search_face(const ScanPictures& pictures, const FaceFinder& finder);

}  // namespace vultus::registration
