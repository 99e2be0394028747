#pragma once

#include <vector>

#include "register/method.h"

namespace vultus::registration {

/// Where a person's registered neutral stands in the scan of another pose.
struct ExpressionStart {
  Similarity scan_from_face;  ///< rigid
  std::vector<int> steady;    ///< refined vertices that told it, and tell it again once the pose is fitted
  Points rest;                ///< the neutral there: refined topology, scan frame, mm
  Anchors anchors;            ///< those that skin can have moved to
  std::vector<std::string> decisions;
};

/// Finds the head's rigid motion from landmarks of nose and eyes, then from skin that expressions leave alone or,
/// where the scan shows little of that, all skin above the lips, last from whatever skin has stayed.
/// Anchors are vertices of the neutral moved as their sightings moved from scan to scan, so that what the finder gets
/// wrong alike on both does no harm. Throws `InputError` when fewer than 6 landmarks can be trusted.
ExpressionStart start_expression(const FitInput& input, const Registered& neutral);

/// The rigid motion that takes a fitted pose (refined topology, scan frame) to the neutral's place by its steady skin.
Similarity back_to_neutral(const std::vector<int>& steady, const Registered& neutral, const Points& positions);

}  // namespace vultus::registration
