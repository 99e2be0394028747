#pragma once

#include <map>
#include <string>
#include <vector>

#include "register/scan_surface.h"
#include "register/template.h"

namespace vultus::registration {

enum class Verdict { pass, warn, fail };
std::string verdict_name(Verdict verdict);

/// How one named vertex set (or "all" fitted vertices) lies on the scan; distances in mm.
struct SetQuality {
  int vertices = 0;
  double coverage = 0.0;                                   ///< share of the vertices with data beneath, [0, 1]
  double mesh_to_scan_mean = 0.0, mesh_to_scan_p95 = 0.0;  ///< over covered vertices
  double scan_to_mesh_mean = 0.0, scan_to_mesh_p95 = 0.0;  ///< over the scan's vertices nearest to the set
};

struct LandmarkResidual {
  std::string name;
  double distance = 0.0;  ///< mm between the place on the result and the landmark on the scan
  double confidence = 0.0;
};

struct QualityLimits {
  double pass_mean = 0.3, fail_mean = 1.0;             ///< mm, scan to mesh in "face" (or "all")
  double pass_coverage = 0.85, fail_coverage = 0.5;    ///< share of the face with data
  double pass_landmarks = 5.0, fail_landmarks = 12.0;  ///< mm, confidence-weighted mean residual
  double stretch = 3.0;                                ///< edge-length ratio to the reference beyond which it counts
  double data_within = 5.0;                            ///< mm: farther scan is no data for a vertex
  double sealed_gap = 1.5;                             ///< mm between inner lips up to which the mouth counts as closed
};

/// Everything a person needs to trust or distrust one registration.
struct Quality {
  std::map<std::string, SetQuality> sets;
  Eigen::VectorXf vertex_distance;  ///< vertex_count, mm; NaN where the vertex has no data
  int flipped_triangles = 0;        ///< folded over against their surroundings, in the fitted skin
  int stretched_triangles = 0;
  double mouth_gap = -1.0;  ///< mm between inner lips; -1 without such landmarks
  bool lips_sealed = false;
  std::vector<LandmarkResidual> landmarks;
  double landmark_mean = 0.0;  ///< confidence-weighted, mm
  double size_ratio = 1.0;     ///< outer-eye distance to the reference's
  Verdict verdict = Verdict::pass;
  std::vector<std::string> reasons;  ///< in words, worst first; empty for a clean pass
};

/// Judges `positions` (scan frame) against the scan where vertices are `fitted`; `reference` is the same topology
/// before fitting (template or neutral, any frame). `head` gives lips and eyes, whose control vertices keep their
/// numbers after subdivision.
Quality judge(const Template& head, const Topology& topology, const std::vector<bool>& fitted, const Points& reference,
              const Points& positions, const ScanSurface& scan, const std::vector<LandmarkResidual>& landmarks,
              const QualityLimits& limits = {});

}  // namespace vultus::registration
