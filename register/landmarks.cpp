#include "register/landmarks.h"

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "core/error.h"
#include "core/files.h"

namespace vultus::registration {
using nlohmann::json;

namespace {

const std::string ibug_prefix = "ibug.";

Eigen::Vector3d read_point(const std::filesystem::path& file, const std::string& place, const json& value) {
  if (!value.is_array() || value.size() != 3) throw InputError(file, place, "must be a list [x, y, z]");
  Eigen::Vector3d point;
  for (int axis = 0; axis < 3; ++axis) {
    if (!value[axis].is_number()) throw InputError(file, place, "must hold three numbers");
    point[axis] = value[axis].get<double>();
    if (!std::isfinite(point[axis])) throw InputError(file, place, "must hold finite numbers");
  }
  return point;
}

}  // namespace

double distance_between(const ScanLandmarks& landmarks, const std::string& a, const std::string& b) {
  const Eigen::Vector3d *first = nullptr, *second = nullptr;
  for (const ScanLandmark& landmark : landmarks) {
    if (landmark.name == a) first = &landmark.position;
    if (landmark.name == b) second = &landmark.position;
  }
  return first && second ? (*first - *second).norm() : 0.0;
}

std::string ibug_name(int index) { return ibug_prefix + std::to_string(index); }

std::optional<int> ibug_index(const std::string& name) {
  if (!name.starts_with(ibug_prefix)) return {};
  int index = -1;
  const char* begin = name.data() + ibug_prefix.size();
  const char* end = name.data() + name.size();
  const auto [stopped, error] = std::from_chars(begin, end, index);
  if (error != std::errc() || stopped != end || index < 0 || index >= 68) return {};
  return index;
}

std::optional<int> landmark_vertex(const Template& head, const std::string& name) {
  for (const Landmark& landmark : head.landmarks)
    if (landmark.name == name && landmark.vertex >= 0) return landmark.vertex;
  const std::optional<int> index = ibug_index(name);
  if (index && head.ibug68 && (*head.ibug68)[*index] >= 0) return (*head.ibug68)[*index];
  return {};
}

LandmarkPairs pair_landmarks(const Template& head, const ScanLandmarks& landmarks, bool chin) {
  LandmarkPairs pairs;
  std::vector<const ScanLandmark*> used;
  std::set<int> taken;
  for (const ScanLandmark& landmark : landmarks) {
    const std::optional<int> index = ibug_index(landmark.name);
    if (index && is_contour(*index) && !(chin && *index >= 7 && *index <= 9)) continue;
    const std::optional<int> vertex = landmark_vertex(head, landmark.name);
    if (!vertex && !index && landmark.confidence >= 1.0) {
      std::vector<std::string> names;
      for (const Landmark& known : head.landmarks) names.push_back(known.name);
      const std::string near = nearest_name(landmark.name, names);
      throw InputError("the template has no landmark \"" + landmark.name + "\"" +
                       (near.empty() ? "" : "; did you mean \"" + near + "\"?"));
    }
    if (!vertex || landmark.confidence <= 0.0 || !taken.insert(*vertex).second) continue;
    pairs.names.push_back(landmark.name);
    pairs.vertices.push_back(*vertex);
    used.push_back(&landmark);
  }
  pairs.scan.resize(used.size(), 3);
  pairs.confidence.resize(used.size());
  for (int i = 0; i < pairs.size(); ++i) {
    pairs.scan.row(i) = used[i]->position;
    pairs.confidence[i] = used[i]->confidence;
    pairs.pictured.push_back(used[i]->pictured);
  }
  return pairs;
}

ScanLandmarks read_landmarks(const std::filesystem::path& file, double mm_per_unit) {
  const json content = read_json(file);
  if (!content.is_object() || !content.contains("points"))
    throw InputError(file, "top level", R"(must be {"points": {"NAME": [x, y, z], …}})");
  const json& points = content.at("points");
  ScanLandmarks landmarks;
  auto add = [&](const std::string& name, const json& value) {
    landmarks.push_back({name, mm_per_unit * read_point(file, "points." + name, value), 1.0});
  };
  if (points.is_array()) {
    if (points.size() != 68) throw InputError(file, "points", "a list must hold the 68 points of the iBUG scheme");
    for (int i = 0; i < 68; ++i) add(ibug_name(i), points[i]);
  } else if (points.is_object()) {
    for (const auto& [name, value] : points.items()) add(name, value);
  } else {
    throw InputError(file, "points", "must map names to [x, y, z]");
  }
  return landmarks;
}

void write_landmarks(const std::filesystem::path& file, const ScanLandmarks& landmarks) {
  json points = json::object(), confidence = json::object();
  for (const ScanLandmark& landmark : landmarks) {
    points[landmark.name] = {landmark.position.x(), landmark.position.y(), landmark.position.z()};
    confidence[landmark.name] = landmark.confidence;
  }
  write_json(file, {{"points", points}, {"confidence", confidence}});
}

}  // namespace vultus::registration
