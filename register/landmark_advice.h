#pragma once

#include <string>

#include "register/landmarks.h"

namespace vultus::registration {

/// Where on a face a point of the 68-point scheme is ("right corner of the mouth"; right and left are the subject's);
/// for any other name an empty text.
std::string place_in_words(const std::string& name);

/// Which points a person should place on this pose's scan, where they are and in which file; empty when none need to
/// be. Told are the eleven that hold a face (nose tip, corners of eyes and mouth, middles of the lips, chin), where
/// they were not found or with a confidence below `doubtful`.
std::string landmark_advice(const std::string& pose, const ScanLandmarks& found, double doubtful = 0.2);

}  // namespace vultus::registration
