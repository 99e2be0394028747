#include "register/quality.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "core/rays.h"
#include "register/crumples.h"
#include "register/face_regions.h"
#include "register/unfold.h"
#include "scan/self_intersections.h"

namespace vultus::registration {
namespace {

using Flags = std::vector<bool>;

struct Spread {
  double mean = 0.0, p95 = 0.0;
};

Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  const auto place = values.begin() + (values.size() - 1) * 95 / 100;
  std::nth_element(values.begin(), place, values.end());
  return {sum / static_cast<double>(values.size()), *place};
}

// Distance of each fitted vertex to data that faces the same way, and the share that has only data facing away.
struct VertexDistances {
  Eigen::VectorXf distance;  // NaN without data
  double facing_away = 0.0;
};

VertexDistances distances_to_scan(const Topology& topology, const Points& positions, const ScanSurface& scan,
                                  const Flags& fitted, double limit) {
  const Points normals = vertex_normals(topology, positions);
  VertexDistances result;
  result.distance.setConstant(topology.vertex_count(), std::numeric_limits<float>::quiet_NaN());
  std::vector<char> away(topology.vertex_count(), 0);
  tbb::parallel_for(0, topology.vertex_count(), [&](int v) {
    if (!fitted[v]) return;
    if (const auto place = scan.nearest(positions.row(v), normals.row(v), limit, 0.0))
      result.distance[v] = static_cast<float>(place->distance);
    else
      away[v] = scan.nearest(positions.row(v), -normals.row(v), limit, 0.3).has_value();
  });
  const auto vertices = std::count(fitted.begin(), fitted.end(), true);
  result.facing_away = static_cast<double>(std::count(away.begin(), away.end(), 1)) / std::max<double>(1.0, vertices);
  return result;
}

// For a sample of the scan's vertices: distance to the mesh and the mesh triangle beneath, -1 where it is too far.
struct ScanSample {
  std::vector<double> distance;
  std::vector<int> triangle;
  double elsewhere = 0.0;  // share of them that is far from all of the mesh
};

ScanSample distances_to_mesh(const Topology& topology, const Points& positions, const ScanSurface& scan,
                             const QualityLimits& limits) {
  const RayScene mesh(topology, positions);
  const Points mesh_normals = triangle_normals(topology, positions);
  const Points& scanned = scan.mesh().positions;
  const int step = std::max(1, static_cast<int>(scanned.rows()) / 60000);
  ScanSample sample;
  sample.distance.assign((scanned.rows() + step - 1) / step, 0.0);
  sample.triangle.assign(sample.distance.size(), -1);
  std::vector<char> elsewhere(sample.distance.size(), 0);
  tbb::parallel_for(0, static_cast<int>(sample.distance.size()), [&](int i) {
    const auto place = mesh.closest(scanned.row(i * step), limits.elsewhere_beyond);
    elsewhere[i] = !place.has_value();
    if (!place || place->distance > limits.data_within || scan.is_invented(i * step)) return;
    if (mesh_normals.row(place->place.triangle).dot(scan.vertex_normal(i * step)) < 0.0) return;
    sample.distance[i] = place->distance;
    sample.triangle[i] = place->place.triangle;
  });
  sample.elsewhere = static_cast<double>(std::count(elsewhere.begin(), elsewhere.end(), 1)) /
                     std::max<double>(1.0, static_cast<double>(elsewhere.size()));
  return sample;
}

Flags triangles_inside(const Topology& topology, const Flags& vertices) {
  const Triangles& triangles = topology.triangles();
  Flags inside(triangles.rows());
  for (int t = 0; t < triangles.rows(); ++t)
    inside[t] = vertices[triangles(t, 0)] && vertices[triangles(t, 1)] && vertices[triangles(t, 2)];
  return inside;
}

// Triangles with an edge `limit` times longer or shorter, against the reference, than is usual in the fitted skin.
Flags stretched_triangles(const Topology& topology, const Points& reference, const Points& positions,
                          const Flags& fitted, double limit) {
  const Triangles& triangles = topology.triangles();
  const Flags inside = triangles_inside(topology, fitted);
  auto ratio = [&](int t, int k) {
    const int a = triangles(t, k), b = triangles(t, (k + 1) % 3);
    return (positions.row(a) - positions.row(b)).norm() / std::max(1e-9, (reference.row(a) - reference.row(b)).norm());
  };
  std::vector<double> all;
  for (int t = 0; t < triangles.rows(); ++t)
    if (inside[t]) all.push_back(ratio(t, 0));
  Flags stretched(triangles.rows(), false);
  if (all.empty()) return stretched;
  std::nth_element(all.begin(), all.begin() + all.size() / 2, all.end());
  const double usual = std::max(1e-9, all[all.size() / 2]);
  for (int t = 0; t < triangles.rows(); ++t)
    for (int k = 0; inside[t] && k < 3; ++k) {
      const double relative = ratio(t, k) / usual;
      stretched[t] = stretched[t] || relative >= limit || relative <= 1.0 / limit;
    }
  return stretched;
}

// Triangles among `chosen` that pass through another of them in `positions` but not so in `reference`.
Flags crossing_triangles(const Topology& topology, const Points& reference, const Points& positions,
                         const Flags& chosen, double depth) {
  std::vector<int> rows;
  for (std::size_t t = 0; t < chosen.size(); ++t)
    if (chosen[t]) rows.push_back(static_cast<int>(t));
  const Triangles skin = topology.triangles()(rows, Eigen::all);
  const auto before = scan::self_intersections(skin, reference, depth);
  Flags crossing(chosen.size(), false);
  for (const auto& pair : scan::self_intersections(skin, positions, depth))
    if (!std::binary_search(before.begin(), before.end(), pair))
      crossing[rows[pair.first]] = crossing[rows[pair.second]] = true;
  return crossing;
}

// Skin of the face that anyone sees, whether a scanner does (nostrils) or not.
Flags visible_face(const Topology& topology, const Flags& skin) {
  Flags visible = skin;
  if (!topology.has_set("face")) return visible;
  for (const char* set : {"face", "nostrils"})
    if (topology.has_set(set))
      for (int v : topology.set(set)) visible[v] = true;
  return visible;
}

// What is wrong with each triangle.
struct Shape {
  Flags flipped, stretched, crossing, crumpled;
};

SetQuality judge_region(const Topology& topology, const Flags& inside, const Eigen::VectorXf& vertex_distance,
                        const ScanSample& sample, const Shape& shape) {
  SetQuality quality;
  std::vector<double> out, back;
  for (int v = 0; v < topology.vertex_count(); ++v) {
    if (!inside[v]) continue;
    ++quality.vertices;
    if (!std::isnan(vertex_distance[v])) out.push_back(vertex_distance[v]);
  }
  quality.coverage = quality.vertices > 0 ? static_cast<double>(out.size()) / quality.vertices : 0.0;
  const Flags triangles = triangles_inside(topology, inside);
  for (std::size_t i = 0; i < sample.triangle.size(); ++i)
    if (sample.triangle[i] >= 0 && triangles[sample.triangle[i]]) back.push_back(sample.distance[i]);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (!triangles[t]) continue;
    ++quality.triangles;
    quality.flipped += shape.flipped[t];
    quality.stretched += shape.stretched[t];
    quality.crossing += shape.crossing[t];
    quality.crumpled += shape.crumpled[t];
  }
  const Spread forward = spread_of(std::move(out)), backward = spread_of(std::move(back));
  quality.mesh_to_scan_mean = forward.mean;
  quality.mesh_to_scan_p95 = forward.p95;
  quality.scan_to_mesh_mean = backward.mean;
  quality.scan_to_mesh_p95 = backward.p95;
  return quality;
}

std::optional<double> between(const Template& head, const Points& positions, int a, int b) {
  if (!head.ibug68 || (*head.ibug68)[a] < 0 || (*head.ibug68)[b] < 0) return {};
  return (positions.row((*head.ibug68)[a]) - positions.row((*head.ibug68)[b])).norm();
}

void judge_features(const Template& head, const Points& reference, const Points& positions, const ScanSurface& scan,
                    const QualityLimits& limits, Quality& quality) {
  double gap = 0.0;
  int pairs = 0;
  for (const auto& [upper, lower] : {std::pair(61, 67), std::pair(62, 66), std::pair(63, 65)})
    if (const auto distance = between(head, positions, upper, lower)) {
      gap += *distance;
      ++pairs;
    }
  if (pairs > 0) quality.mouth_gap = gap / pairs;
  quality.lips_sealed = pairs > 0 && quality.mouth_gap <= limits.sealed_gap;
  quality.seals = find_seals(head, positions, scan);
  const auto eyes = between(head, positions, 36, 45), eyes_before = between(head, reference, 36, 45);
  if (eyes && eyes_before && *eyes_before > 0.0) quality.size_ratio = *eyes / *eyes_before;
}

double weighted_mean(const std::vector<LandmarkResidual>& landmarks) {
  double sum = 0.0, total = 0.0;
  for (const LandmarkResidual& landmark : landmarks) {
    sum += landmark.confidence * landmark.distance;
    total += landmark.confidence;
  }
  return total > 0.0 ? sum / total : 0.0;
}

}  // namespace

Quality judge(const Template& head, const Topology& topology, const std::vector<bool>& fitted, const Points& reference,
              const Points& positions, const ScanSurface& scan, const std::vector<LandmarkResidual>& landmarks,
              const QualityLimits& limits, const ScanFacts& facts) {
  Quality quality;
  const VertexDistances distances = distances_to_scan(topology, positions, scan, fitted, limits.data_within);
  quality.vertex_distance = distances.distance;
  quality.facing_away = distances.facing_away;
  const ScanSample sample = distances_to_mesh(topology, positions, scan, limits);
  quality.elsewhere = sample.elsewhere;

  const auto regions = face_regions(head, topology, reference, fitted);
  const auto face = regions.find("face");
  const Flags& skin = face != regions.end() ? face->second : fitted;
  Flags chosen = skin;  // rims of lips and lids are no part of every template's face
  for (const char* name : {"lips", "eyes"})
    if (const auto region = regions.find(name); region != regions.end())
      for (std::size_t v = 0; v < chosen.size(); ++v) chosen[v] = chosen[v] || region->second[v];
  const Flags triangles = triangles_inside(topology, chosen);
  const Shape shape{folded_triangles(topology, reference, positions),
                    stretched_triangles(topology, reference, positions, skin, limits.stretch),
                    crossing_triangles(topology, reference, positions, triangles, limits.crossing_depth),
                    crumpled_triangles(topology, reference, positions)};
  for (const auto& [name, inside] : regions)
    quality.sets[name] = judge_region(topology, inside, quality.vertex_distance, sample, shape);
  const Flags judged = triangles_inside(topology, skin),
              visible = triangles_inside(topology, visible_face(topology, skin));
  for (std::size_t t = 0; t < judged.size(); ++t) {
    quality.flipped_triangles += judged[t] && shape.flipped[t];
    quality.stretched_triangles += judged[t] && shape.stretched[t];
    quality.crossing_triangles += triangles[t] && shape.crossing[t];
    quality.crumpled_triangles += visible[t] && shape.crumpled[t];
  }
  judge_features(head, reference, positions, scan, limits, quality);
  quality.landmarks = landmarks;
  quality.landmark_mean = weighted_mean(landmarks);
  quality.facts = facts;
  reach_verdict(limits, quality);
  return quality;
}

}  // namespace vultus::registration
