#pragma once

#include <map>
#include <string>
#include <vector>

#include "register/template.h"

namespace vultus::registration {

/// Parts of a face that are judged one by one: name → flag a vertex of `topology` (the template's, refined or not).
/// "face", "lips", "eyes" (lids and what is around them), "ears" and "neck" are the template's sets of those names
/// where it has them; "forehead", "nose", "chin", "under_chin", the face's "front" (from chin to forehead, short of
/// temples and ears), "left_half" and "right_half" (the subject's) are measured out from the 68-point scheme on the
/// template's own shape (its control vertices come first in `positions`, any frame). "all" is every vertex. Vertices
/// that are not `fitted` belong to no region, and regions without any vertex are left out.
std::map<std::string, std::vector<bool>> face_regions(const Template& head, const Topology& topology,
                                                      const Points& positions, const std::vector<bool>& fitted);

}  // namespace vultus::registration
