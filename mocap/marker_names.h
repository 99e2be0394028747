#pragma once

#include <string>
#include <vector>

namespace vultus::mocap {

/// `names` made fit for a take of `markers` markers: surplus names dropped, missing or empty ones called "point_N"
/// (N from 1), the second and later of equal ones given "_2", "_3", …; each change stands in `decisions`.
std::vector<std::string> unique_names(std::vector<std::string> names, std::size_t markers,
                                      std::vector<std::string>& decisions);

}  // namespace vultus::mocap
