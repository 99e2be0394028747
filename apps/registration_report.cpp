#include "apps/registration_report.h"

#include <cmath>
#include <cstdio>

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
  json regions = json::object(), decisions = cleaning;
  for (const auto& [name, set] : quality.sets) {
    if (set.coverage > 0.0) regions[name] = set.mesh_to_scan_mean;
  }
  for (const std::string& line : registered.decisions) decisions.push_back(line);
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
          {"lips_sealed", quality.lips_sealed},
          {"regions_mm", regions},
          {"decisions", decisions}};
}

std::string summary_line(const json& report) {
  char distance[64];
  std::snprintf(distance, sizeof distance, ", %.2f mm", report.at("distance_mm").at("mean").get<double>());
  const std::string reason = report.at("reason");
  return report.at("pose").get<std::string>() + ": " + report.at("verdict").get<std::string>() + distance +
         (reason.empty() ? "" : " (" + reason + ")");
}

}  // namespace vultus::apps
