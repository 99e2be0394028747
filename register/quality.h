#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "register/scan_facts.h"
#include "register/scan_surface.h"
#include "register/seals.h"
#include "register/template.h"

namespace vultus::registration {

enum class Verdict { pass, warn, fail };
std::string verdict_name(Verdict verdict);

/// How one region (register/face_regions.h) lies on the scan, and what became of its triangles; distances in mm.
struct SetQuality {
  int vertices = 0;
  double coverage = 0.0;                                   ///< share of the vertices with data beneath, [0, 1]
  double mesh_to_scan_mean = 0.0, mesh_to_scan_p95 = 0.0;  ///< over covered vertices
  double scan_to_mesh_mean = 0.0, scan_to_mesh_p95 = 0.0;  ///< over the scan's vertices nearest to the region
  int triangles = 0;
  int flipped = 0, stretched = 0, crossing = 0, crumpled = 0;  ///< triangles of it, see `Quality`
};

struct LandmarkResidual {
  std::string name;
  double distance = 0.0;  ///< mm between the place on the result and the landmark on the scan
  double confidence = 0.0;
};

struct QualityLimits {
  double pass_mean = 0.3, fail_mean = 1.0;             ///< mm, scan to mesh in "face" (or "all")
  double pass_region = 0.8;                            ///< mm, scan to mesh in any part of the face
  double pass_coverage = 0.85, fail_coverage = 0.5;    ///< share of the face with data
  double region_coverage = 0.5;                        ///< the same for any part of the face
  double pass_landmarks = 5.0, fail_landmarks = 12.0;  ///< mm, confidence-weighted mean residual
  double pass_offset = 2.5, fail_offset = 8.0;         ///< mm, landmarks from the scan's surface
  double pass_misfit = 9.0, fail_misfit = 18.0;        ///< mm, landmarks from those of a template moved to them
  double stretch = 3.0;                                ///< edge-length ratio to the reference beyond which it counts
  double crossing_depth = 0.2;                         ///< mm by which triangles must pass through one another to count
  double data_within = 5.0;                            ///< mm: farther scan is no data for a vertex
  double elsewhere_beyond = 15.0;           ///< mm: scan farther from the result than this belongs to something else
  double pass_elsewhere = 0.5;              ///< share of the scan that may
  double sealed_gap = 2.0, open_gap = 3.5;  ///< mm between rims: up to the first they are sealed, from the second open
};

/// Everything a person needs to trust or distrust one registration.
struct Quality {
  std::map<std::string, SetQuality> sets;  ///< by region
  Eigen::VectorXf vertex_distance;         ///< vertex_count, mm; NaN where the vertex has no data
  int flipped_triangles = 0;               ///< folded over against their surroundings, in the fitted face
  int stretched_triangles = 0;             ///< with an edge `stretch` times longer or shorter than its surroundings'
  int crossing_triangles = 0;              ///< that pass through another of the fitted face, and did not before fitting
  int crumpled_triangles = 0;              ///< bent sharply against a neighbour (register/crumples.h), in all the face
  std::vector<Seal> seals;                 ///< lips and lids, in the mesh and in the scan
  double mouth_gap = -1.0;                 ///< mm between inner lips; -1 without such landmarks
  bool lips_sealed = false;
  std::vector<LandmarkResidual> landmarks;
  double landmark_mean = 0.0;  ///< confidence-weighted, mm
  double size_ratio = 1.0;     ///< outer-eye distance to the reference's
  double facing_away = 0.0;    ///< share of the fitted vertices whose nearest scan looks the other way
  double elsewhere = 0.0;      ///< share of the scan's vertices that lie far from the result
  ScanFacts facts;
  Verdict verdict = Verdict::pass;
  std::vector<std::string> reasons;  ///< in words, worst first; empty for a clean pass
};

/// Judges `positions` (scan frame) against the scan where vertices are `fitted`; `reference` is the same topology
/// before fitting (template or neutral, any frame). `head` gives lips and eyes, whose control vertices keep their
/// numbers after subdivision. Some 0.1 s for 20,000 vertices.
Quality judge(const Template& head, const Topology& topology, const std::vector<bool>& fitted, const Points& reference,
              const Points& positions, const ScanSurface& scan, const std::vector<LandmarkResidual>& landmarks,
              const QualityLimits& limits = {}, const ScanFacts& facts = {});

/// Verdict and reasons from everything else in `quality`.
void reach_verdict(const QualityLimits& limits, Quality& quality);

}  // namespace vultus::registration
