#pragma once

#include <string>
#include <vector>

#include "apps/virtual_stage/muscles.h"

namespace vultus::virtual_stage {

/// One pose of a scan session.
struct Expression {
  std::string name;
  std::vector<std::string> tags;  ///< FACS units ("AU12"), ARKit names ("mouthSmile"), visemes ("viseme_AI")
  Activations activations;        ///< the same on both sides
};

/// The poses of the virtual actors' scan sessions: neutral first, 17 expressions, and the phonemes AI, O, E and FV of
/// Preston Blair's series (Liu §6.2 scans as many).
const std::vector<Expression>& expression_database();

/// The one called `name`; throws `InputError` with the nearest name.
const Expression& expression(const std::string& name);

}  // namespace vultus::virtual_stage
