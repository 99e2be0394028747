#include "rig/feature_points.h"

namespace vultus::rig {

const std::vector<std::pair<int, std::string>>& mpeg4_names() {
  static const std::vector<std::pair<int, std::string>> names = {
      {8, "2.1"},  {17, "4.6"},  {19, "4.4"},  {21, "4.2"},  {22, "4.1"}, {24, "4.3"},  {26, "4.5"}, {30, "9.3"},
      {31, "9.2"}, {33, "9.15"}, {35, "9.1"},  {36, "3.12"}, {39, "3.8"}, {42, "3.11"}, {45, "3.7"}, {48, "8.4"},
      {50, "8.9"}, {51, "8.1"},  {52, "8.10"}, {54, "8.3"},  {57, "8.2"}, {60, "2.5"},  {61, "2.7"}, {62, "2.2"},
      {63, "2.6"}, {64, "2.4"},  {65, "2.8"},  {66, "2.3"},  {67, "2.9"}};
  return names;
}

registration::Ibug68 face_points(const Topology& topology, const std::optional<registration::Ibug68>& ibug68) {
  registration::Ibug68 points{};
  if (ibug68)
    points = *ibug68;
  else
    points.fill(-1);
  for (const auto& [point, name] : mpeg4_names()) {
    const auto found = topology.landmarks().find(name);
    if (points[point] < 0 && found != topology.landmarks().end()) points[point] = found->second;
  }
  return points;
}

}  // namespace vultus::rig
