#pragma once

#include <string>
#include <vector>

namespace vultus::scan {
struct CleanReport;
}

namespace vultus::registration {

struct Fit;
struct FitInput;

/// What was found out about a scan and its landmarks before and beside the fit, and that bears on how far the result
/// can be trusted. What cleaning repaired is told here too: a repair may be wrong, and a person should know of it.
struct ScanFacts {
  std::string unit;               ///< read out of the scan's size ("cm"); empty when told or plain millimetres
  bool unit_certain = true;       ///< false: the size fits no head in any usual unit
  double rescaled = 1.0;          ///< factor by which the eyes' distance corrected the unit
  bool inside_out = false;        ///< triangles looked inwards and were turned
  int other_heads = 0;            ///< further pieces, or faces, of a head's size
  double tilt_degrees = 0.0;      ///< between the scan's +y axis and the top of the head
  double landmark_offset = -1.0;  ///< mm, median distance of the landmarks from the scan's surface; -1 without any
  double landmark_misfit = -1.0;  ///< mm, median distance to the template's, brought there by a similarity; -1 likewise
  std::vector<std::string> doubts;  ///< whatever else is a reason for a warning, in words
};

/// What cleaning tells.
ScanFacts facts_of(const scan::CleanReport& report);

/// Adds what preparation and fit tell: landmarks, the head's pose, the unit as the eyes see it.
void add_facts(const FitInput& input, const Fit& fit, ScanFacts& facts);

}  // namespace vultus::registration
