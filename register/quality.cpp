#include "register/quality.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/neighbours.h"
#include "core/rays.h"
#include "register/unfold.h"

namespace vultus::registration {
namespace {

struct Spread {
  double mean = 0.0, p95 = 0.0;
};

Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  double sum = 0.0;
  for (double value : values) sum += value;
  const auto place = values.begin() + (values.size() - 1) * 95 / 100;
  std::nth_element(values.begin(), place, values.end());
  return {sum / static_cast<double>(values.size()), *place};
}

Eigen::VectorXf distances_to_scan(const Topology& topology, const Points& positions, const ScanSurface& scan,
                                  const std::vector<bool>& fitted, double limit) {
  const Points normals = vertex_normals(topology, positions);
  Eigen::VectorXf distances(topology.vertex_count());
  tbb::parallel_for(0, topology.vertex_count(), [&](int v) {
    distances[v] = std::numeric_limits<float>::quiet_NaN();
    if (!fitted[v]) return;
    if (const auto place = scan.nearest(positions.row(v), normals.row(v), limit, 0.0))
      distances[v] = static_cast<float>(place->distance);
  });
  return distances;
}

// For a sample of the scan's vertices: distance to the mesh and the mesh triangle beneath, -1 where it is too far.
struct ScanSample {
  std::vector<double> distance;
  std::vector<int> triangle;
};

ScanSample distances_to_mesh(const Topology& topology, const Points& positions, const ScanSurface& scan, double limit) {
  const RayScene mesh(topology, positions);
  const Points mesh_normals = triangle_normals(topology, positions);
  const Points scan_normals = vertex_normals(*scan.mesh().topology, scan.mesh().positions);
  const int count = scan.mesh().topology->vertex_count();
  const int step = std::max(1, count / 60000);
  ScanSample sample;
  sample.distance.assign((count + step - 1) / step, 0.0);
  sample.triangle.assign(sample.distance.size(), -1);
  tbb::parallel_for(0, static_cast<int>(sample.distance.size()), [&](int i) {
    const auto place = mesh.closest(scan.mesh().positions.row(i * step), limit);
    if (!place || mesh_normals.row(place->place.triangle).dot(scan_normals.row(i * step)) < 0.0) return;
    sample.distance[i] = place->distance;
    sample.triangle[i] = place->place.triangle;
  });
  return sample;
}

SetQuality judge_set(const Topology& topology, const std::vector<bool>& inside, const Eigen::VectorXf& vertex_distance,
                     const ScanSample& sample) {
  SetQuality quality;
  std::vector<double> out, back;
  for (int v = 0; v < topology.vertex_count(); ++v) {
    if (!inside[v]) continue;
    ++quality.vertices;
    if (!std::isnan(vertex_distance[v])) out.push_back(vertex_distance[v]);
  }
  quality.coverage = quality.vertices > 0 ? static_cast<double>(out.size()) / quality.vertices : 0.0;
  for (std::size_t i = 0; i < sample.triangle.size(); ++i) {
    if (sample.triangle[i] < 0) continue;
    const auto corners = topology.triangles().row(sample.triangle[i]);
    if (inside[corners[0]] && inside[corners[1]] && inside[corners[2]]) back.push_back(sample.distance[i]);
  }
  const Spread forward = spread_of(std::move(out)), backward = spread_of(std::move(back));
  quality.mesh_to_scan_mean = forward.mean;
  quality.mesh_to_scan_p95 = forward.p95;
  quality.scan_to_mesh_mean = backward.mean;
  quality.scan_to_mesh_p95 = backward.p95;
  return quality;
}

std::vector<bool> members(const Topology& topology, const std::string& set, const std::vector<bool>& fitted) {
  if (set == "all" || !topology.has_set(set)) return fitted;
  std::vector<bool> inside(topology.vertex_count(), false);
  for (int v : topology.set(set)) inside[v] = fitted[v];
  return inside;
}

int count_flipped(const Topology& topology, const Points& reference, const Points& positions,
                  const std::vector<bool>& fitted) {
  const std::vector<bool> folded = folded_triangles(topology, reference, positions);
  int count = 0;
  for (int t = 0; t < topology.triangles().rows(); ++t) {
    const auto c = topology.triangles().row(t);
    if (folded[t] && fitted[c[0]] && fitted[c[1]] && fitted[c[2]]) ++count;
  }
  return count;
}

int count_stretched(const Topology& topology, const Points& reference, const Points& positions,
                    const std::vector<bool>& fitted, double limit) {
  const Triangles& triangles = topology.triangles();
  auto ratio = [&](int t, int k) {
    const int a = triangles(t, k), b = triangles(t, (k + 1) % 3);
    return (positions.row(a) - positions.row(b)).norm() / std::max(1e-9, (reference.row(a) - reference.row(b)).norm());
  };
  std::vector<double> all;
  for (int t = 0; t < triangles.rows(); ++t)
    if (fitted[triangles(t, 0)] && fitted[triangles(t, 1)]) all.push_back(ratio(t, 0));
  if (all.empty()) return 0;
  std::nth_element(all.begin(), all.begin() + all.size() / 2, all.end());
  const double usual = std::max(1e-9, all[all.size() / 2]);
  int count = 0;
  for (int t = 0; t < triangles.rows(); ++t) {
    if (!fitted[triangles(t, 0)] || !fitted[triangles(t, 1)] || !fitted[triangles(t, 2)]) continue;
    for (int k = 0; k < 3; ++k) {
      const double relative = ratio(t, k) / usual;
      if (relative < limit && relative > 1.0 / limit) continue;
      ++count;
      break;
    }
  }
  return count;
}

std::optional<double> between(const Template& head, const Points& positions, int a, int b) {
  if (!head.ibug68 || (*head.ibug68)[a] < 0 || (*head.ibug68)[b] < 0) return {};
  return (positions.row((*head.ibug68)[a]) - positions.row((*head.ibug68)[b])).norm();
}

void judge_features(const Template& head, const Points& reference, const Points& positions, const QualityLimits& limits,
                    Quality& quality) {
  double gap = 0.0;
  int pairs = 0;
  for (const auto& [upper, lower] : {std::pair(61, 67), std::pair(62, 66), std::pair(63, 65)})
    if (const auto distance = between(head, positions, upper, lower)) {
      gap += *distance;
      ++pairs;
    }
  if (pairs > 0) quality.mouth_gap = gap / pairs;
  quality.lips_sealed = pairs > 0 && quality.mouth_gap <= limits.sealed_gap;
  const auto eyes = between(head, positions, 36, 45), eyes_before = between(head, reference, 36, 45);
  if (eyes && eyes_before && *eyes_before > 0.0) quality.size_ratio = *eyes / *eyes_before;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", value);
  return text;
}

void reach_verdict(const QualityLimits& limits, Quality& quality) {
  std::vector<std::string> failures, warnings;
  auto check = [&](double value, double pass, double fail, const std::string& text) {
    if (value >= fail)
      failures.push_back(text);
    else if (value >= pass)
      warnings.push_back(text);
  };
  const auto face = quality.sets.find("face");
  const SetQuality& main = face != quality.sets.end() ? face->second : quality.sets.at("all");
  check(-main.coverage, -limits.pass_coverage, -limits.fail_coverage,
        "only " + number(100 * main.coverage) + " % of the face lies on data");
  check(main.scan_to_mesh_mean, limits.pass_mean, limits.fail_mean,
        "the scan lies " + number(main.scan_to_mesh_mean) + " mm from the mesh on average");
  check(main.mesh_to_scan_p95, 5 * limits.pass_mean, 5 * limits.fail_mean,
        "a twentieth of the face lies more than " + number(main.mesh_to_scan_p95) + " mm from the scan");
  if (!quality.landmarks.empty())
    check(quality.landmark_mean, limits.pass_landmarks, limits.fail_landmarks,
          "landmarks lie " + number(quality.landmark_mean) + " mm from their places on average");
  check(quality.flipped_triangles, 1, std::max(50.0, 0.02 * main.vertices),
        std::to_string(quality.flipped_triangles) + " triangles folded over");
  check(quality.stretched_triangles, std::max(20.0, 0.01 * main.vertices), std::max(400.0, 0.2 * main.vertices),
        std::to_string(quality.stretched_triangles) + " triangles stretched more than " + number(limits.stretch) +
            " times");
  check(std::abs(std::log(quality.size_ratio)), std::log(1.25), std::log(1.6),
        "the eyes' distance is " + number(quality.size_ratio) +
            " times the reference's: wrong units or wrong landmarks?");
  quality.verdict = !failures.empty() ? Verdict::fail : !warnings.empty() ? Verdict::warn : Verdict::pass;
  quality.reasons = std::move(failures);
  quality.reasons.insert(quality.reasons.end(), warnings.begin(), warnings.end());
}

}  // namespace

std::string verdict_name(Verdict verdict) {
  return verdict == Verdict::pass ? "pass" : verdict == Verdict::warn ? "warn" : "fail";
}

Quality judge(const Template& head, const Topology& topology, const std::vector<bool>& fitted, const Points& reference,
              const Points& positions, const ScanSurface& scan, const std::vector<LandmarkResidual>& landmarks,
              const QualityLimits& limits) {
  Quality quality;
  quality.vertex_distance = distances_to_scan(topology, positions, scan, fitted, limits.data_within);
  const ScanSample sample = distances_to_mesh(topology, positions, scan, limits.data_within);
  quality.sets["all"] = judge_set(topology, fitted, quality.vertex_distance, sample);
  for (const auto& [name, vertices] : topology.sets()) {
    const std::vector<bool> inside = members(topology, name, fitted);
    if (std::find(inside.begin(), inside.end(), true) == inside.end()) continue;
    quality.sets[name] = judge_set(topology, inside, quality.vertex_distance, sample);
  }
  quality.flipped_triangles = count_flipped(topology, reference, positions, members(topology, "face", fitted));
  quality.stretched_triangles =
      count_stretched(topology, reference, positions, members(topology, "face", fitted), limits.stretch);
  judge_features(head, reference, positions, limits, quality);
  quality.landmarks = landmarks;
  double sum = 0.0, total = 0.0;
  for (const LandmarkResidual& landmark : landmarks) {
    sum += landmark.confidence * landmark.distance;
    total += landmark.confidence;
  }
  quality.landmark_mean = total > 0.0 ? sum / total : 0.0;
  reach_verdict(limits, quality);
  return quality;
}

}  // namespace vultus::registration
