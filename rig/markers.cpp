#include "rig/markers.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files.h"

namespace vultus::rig {
namespace {

using Json = nlohmann::json;

SurfacePoint place_from_barycentric(const Json& entry, const Topology& topology, const std::filesystem::path& file,
                                    const std::string& where) {
  const Json& triangle = entry.at("triangle");
  const auto triangles = topology.triangles().rows();
  if (!triangle.is_number_integer() || triangle.get<long long>() < 0 || triangle.get<long long>() >= triangles)
    throw InputError(file, where, "\"triangle\" must be a number from 0 to " + std::to_string(triangles - 1));
  const Json coordinates = entry.value("barycentric", Json());
  if (!coordinates.is_array() || coordinates.size() != 3)
    throw InputError(file, where, "\"barycentric\" must be three numbers");
  SurfacePoint place;
  place.triangle = triangle.get<int>();
  for (int i = 0; i < 3; ++i) {
    if (!coordinates[i].is_number()) throw InputError(file, where, "\"barycentric\" must be three numbers");
    place.barycentric[i] = coordinates[i].get<double>();
  }
  const double sum = place.barycentric.sum();
  if (!(place.barycentric.minCoeff() >= -1e-4) || !(std::abs(sum - 1.0) <= 1e-4))
    throw InputError(file, where, "barycentric coordinates must be at least 0 and sum to one");
  place.barycentric = place.barycentric.cwiseMax(0.0);
  place.barycentric /= place.barycentric.sum();
  return place;
}

int vertex_of_landmark(const Json& name, const Topology& topology, const std::filesystem::path& file,
                       const std::string& where) {
  if (!name.is_string()) throw InputError(file, where, "\"landmark\" must be a name");
  const auto found = topology.landmarks().find(name.get<std::string>());
  if (found != topology.landmarks().end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [known, vertex] : topology.landmarks()) names.push_back(known);
  const std::string nearest = nearest_name(name.get<std::string>(), names);
  throw InputError(file, where,
                   "the topology has no landmark \"" + name.get<std::string>() + "\"" +
                       (nearest.empty() ? std::string() : "; did you mean \"" + nearest + "\"?"));
}

}  // namespace

SurfacePoint place_from_json(const Json& entry, const Topology& topology, const std::filesystem::path& file,
                             const std::string& where) {
  if (!entry.is_object()) throw InputError(file, where, "expected an object with \"triangle\" or \"landmark\"");
  if (entry.contains("triangle")) return place_from_barycentric(entry, topology, file, where);
  int vertex = -1;
  if (entry.contains("landmark")) {
    vertex = vertex_of_landmark(entry["landmark"], topology, file, where);
  } else if (entry.contains("vertex")) {
    const Json& number = entry["vertex"];
    if (!number.is_number_integer() || number.get<long long>() < 0 ||
        number.get<long long>() >= topology.vertex_count())
      throw InputError(file, where, "\"vertex\" must be from 0 to " + std::to_string(topology.vertex_count() - 1));
    vertex = number.get<int>();
  } else {
    throw InputError(file, where, "expected \"triangle\" with \"barycentric\", \"landmark\" or \"vertex\"");
  }
  const SurfacePoint place = place_of_vertex(topology, vertex);
  if (!place.valid()) throw InputError(file, where, "vertex " + std::to_string(vertex) + " belongs to no face");
  return place;
}

SurfacePoint place_of_vertex(const Topology& topology, int vertex) {
  const Triangles& triangles = topology.triangles();
  for (int t = 0; t < triangles.rows(); ++t)
    for (int corner = 0; corner < 3; ++corner)
      if (triangles(t, corner) == vertex) return {t, Eigen::Vector3d::Unit(corner)};
  return {};
}

MarkerPlaces read_markers(const std::filesystem::path& file, const Topology& topology) {
  const Json json = read_json(file);
  if (!json.is_object() || !json.contains("markers") || !json["markers"].is_object())
    throw InputError(file, "expected {\"markers\": {\"LABEL\": …}}");
  MarkerPlaces places;
  for (const auto& [label, entry] : json["markers"].items())
    places[label] = place_from_json(entry, topology, file, "marker \"" + label + "\"");
  return places;
}

void write_markers(const std::filesystem::path& file, const MarkerPlaces& markers) {
  Json entries = Json::object();
  for (const auto& [label, place] : markers)
    entries[label] = {{"triangle", place.triangle},
                      {"barycentric", {place.barycentric.x(), place.barycentric.y(), place.barycentric.z()}}};
  write_json(file, {{"markers", entries}});
}

}  // namespace vultus::rig
