#include "apps/registration_report.h"

#include <cmath>
#include <cstdio>

#include "register/landmark_advice.h"

namespace vultus::apps {
namespace {

using nlohmann::json;

double landmark_rms(const registration::Quality& quality) {
  double sum = 0.0, weight = 0.0;
  for (const auto& landmark : quality.landmarks) {
    sum += landmark.confidence * landmark.distance * landmark.distance;
    weight += landmark.confidence;
  }
  return weight > 0.0 ? std::sqrt(sum / weight) : 0.0;
}

// Over the vertices with data of one set, from the mesh to the scan.
json distance_json(const registration::Quality& quality, const registration::SetQuality& face,
                   const std::vector<int>& vertices) {
  double squares = 0.0, largest = 0.0;
  int count = 0;
  for (const int v : vertices) {
    const double distance = quality.vertex_distance(v);
    if (!std::isfinite(distance)) continue;
    squares += distance * distance;
    largest = std::max(largest, distance);
    ++count;
  }
  return {{"mean", face.scan_to_mesh_mean},
          {"p95", face.scan_to_mesh_p95},
          {"rms", count > 0 ? json(std::sqrt(squares / count)) : json()},
          {"max", count > 0 ? json(largest) : json()}};
}

json seals_json(const registration::Quality& quality) {
  json seals = json::array();
  for (const registration::Seal& seal : quality.seals)
    seals.push_back({{"name", seal.name},
                     {"mesh_mm", seal.mesh_gap},
                     {"scan_mm", seal.scan_gap < 0.0 ? json() : json(seal.scan_gap)}});
  return seals;
}

json regions_json(const registration::Quality& quality) {
  json regions = json::object();
  for (const auto& [name, set] : quality.sets)
    regions[name] = {{"mean", set.scan_to_mesh_mean}, {"p95", set.scan_to_mesh_p95}, {"coverage", set.coverage},
                     {"flipped", set.flipped},        {"stretched", set.stretched},  {"crossing", set.crossing},
                     {"crumpled", set.crumpled}};
  return regions;
}

}  // namespace

json pose_report(const CapturedPose& pose, const registration::Registered& registered,
                 const std::vector<std::string>& cleaning) {
  const registration::Quality& quality = registered.quality;
  const Topology& topology = *registered.mesh.topology;
  const std::string face = quality.sets.contains("face") ? "face" : "all";
  std::vector<int> vertices;
  if (topology.has_set(face))
    vertices = topology.set(face);
  else
    for (int v = 0; v < topology.vertex_count(); ++v) vertices.push_back(v);
  json regions = json::object();
  for (const auto& [name, set] : quality.sets) {
    if (set.coverage > 0.0) regions[name] = set.mesh_to_scan_mean;
  }
  json decisions = cleaning;
  for (const std::string& line : registered.decisions) decisions.push_back(line);
  const std::string advice = registration::landmark_advice(pose.name, registered.detected);
  if (!advice.empty()) decisions.push_back(advice);
  std::string reason;
  for (const std::string& line : quality.reasons) reason += (reason.empty() ? "" : "; ") + line;
  const auto found = quality.sets.find(face);
  const registration::SetQuality set = found == quality.sets.end() ? registration::SetQuality{} : found->second;
  return {{"pose", pose.name},
          {"source", "scan"},
          {"scan", pose.scan.string()},
          {"verdict", registration::verdict_name(quality.verdict)},
          {"reason", reason},
          {"distance_mm", distance_json(quality, set, vertices)},
          {"coverage", set.coverage},
          {"landmark_rms_mm", landmark_rms(quality)},
          {"landmarks", quality.landmarks.size()},
          {"flipped_triangles", quality.flipped_triangles},
          {"stretched_triangles", quality.stretched_triangles},
          {"crossing_triangles", quality.crossing_triangles},
          {"crumpled_triangles", quality.crumpled_triangles},
          {"lips_sealed", quality.lips_sealed},
          {"seals", seals_json(quality)},
          {"regions", regions_json(quality)},
          {"regions_mm", regions},
          {"reasons", quality.reasons},
          {"cleaning", cleaning},
          {"landmark_advice", advice},
          {"decisions", decisions}};
}

json unregistered_report(const std::string& pose, const std::string& problem) {
  std::string reason = "not registered: " + problem;
  // Messages from below do not know which pose they are about.
  for (std::size_t at; (at = reason.find("<pose>")) != std::string::npos;) reason.replace(at, 6, pose);
  return {{"pose", pose},        {"source", "scan"},       {"verdict", "fail"},         {"reason", reason},
          {"reasons", {reason}}, {"distance_mm", nullptr}, {"decisions", json::array()}};
}

std::string summary_line(const json& report) {
  char distance[64];
  std::snprintf(distance, sizeof distance, ", %.2f mm", report.at("distance_mm").at("mean").get<double>());
  const std::string reason = report.at("reason");
  return report.at("pose").get<std::string>() + ": " + report.at("verdict").get<std::string>() + distance +
         (reason.empty() ? "" : " (" + reason + ")");
}

}  // namespace vultus::apps
