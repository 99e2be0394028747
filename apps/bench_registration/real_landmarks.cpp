#include "apps/bench_registration/real_landmarks.h"

#include <array>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/files.h"
#include "register/landmarks.h"

namespace vultus::apps::bench {

using nlohmann::json;

PlacedLandmarks read_ljson(const std::filesystem::path& file) {
  PlacedLandmarks placed;
  try {
    const json group = read_json(file).at("groups").begin().value();
    const json& points = group.at("landmarks").at("points");
    int index = 0;
    for (const char* wanted : {"chin", "leyebrow", "reyebrow", "nose", "leye", "reye", "mouth"})
      for (const json& label : group.at("labels")) {
        if (label.at("label") != wanted) continue;
        for (const int row : label.at("mask").get<std::vector<int>>()) {
          const json& point = points.at(static_cast<std::size_t>(row));
          const bool known = point.at(0).is_number() && point.at(1).is_number() && point.at(2).is_number();
          if (known && !registration::is_contour(index))
            placed[index] = {point[0].get<double>(), point[1].get<double>(), point[2].get<double>()};
          ++index;
        }
      }
    if (index != 68) throw InputError(file, "has " + std::to_string(index) + " labelled points, 68 are expected");
  } catch (const json::exception& problem) {
    throw InputError(file, std::string("is no .ljson of 68 points: ") + problem.what());
  }
  return placed;
}

PlacedLandmarks read_five_points(const std::filesystem::path& file) {
  constexpr std::array<int, 5> scheme = {39, 42, 30, 48, 54};
  std::istringstream text(read_file(file));
  PlacedLandmarks placed;
  std::string line;
  for (std::size_t i = 0; i < scheme.size(); ++i) {
    std::getline(text, line);
    std::istringstream row(line);
    Eigen::Vector3d point;
    char comma = 0;
    if (!(row >> point.x() >> comma >> point.y() >> comma >> point.z()))
      throw InputError(file, "line " + std::to_string(i + 1), "must be x,y,z");
    placed[scheme[i]] = point;
  }
  return placed;
}

}  // namespace vultus::apps::bench
