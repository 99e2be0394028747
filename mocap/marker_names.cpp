#include "mocap/marker_names.h"

#include <set>

namespace vultus::mocap {

std::vector<std::string> unique_names(std::vector<std::string> names, std::size_t markers,
                                      std::vector<std::string>& decisions) {
  if (names.size() > markers) {
    decisions.push_back("names: the last " + std::to_string(names.size() - markers) + " of " +
                        std::to_string(names.size()) + " have no marker and were dropped");
  }
  names.resize(markers);
  std::size_t invented = 0;
  std::set<std::string> taken(names.begin(), names.end());
  std::set<std::string> seen;
  for (std::size_t i = 0; i < markers; ++i) {
    const bool empty = names[i].empty();
    const std::string wanted = empty ? "point_" + std::to_string(i + 1) : names[i];
    std::string name = wanted;
    for (int n = 2; seen.contains(name) || (name != names[i] && taken.contains(name)); ++n) {
      name = wanted + "_" + std::to_string(n);
    }
    if (!empty && name != names[i]) decisions.push_back("names: a second '" + wanted + "' is called '" + name + "'");
    invented += empty ? 1 : 0;
    seen.insert(name);
    names[i] = name;
  }
  if (invented > 0)
    decisions.push_back("names: " + std::to_string(invented) + " markers had none and are called point_N");
  return names;
}

}  // namespace vultus::mocap
