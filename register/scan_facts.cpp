#include "register/scan_facts.h"

#include <algorithm>
#include <cmath>

#include "core/statistics.h"
#include "register/method.h"
#include "scan/clean.h"

namespace vultus::registration {
namespace {

// Contour points are outlines of a picture, and what is hardly believed takes no part in the fit either. Where points
// were placed by hand they alone count: those that follow from them were set onto the surface.
double offset_from(const ScanSurface& scan, const ScanLandmarks& landmarks, double least_confidence) {
  if (std::any_of(landmarks.begin(), landmarks.end(), [](const auto& l) { return l.confidence >= 1.0; }))
    least_confidence = 1.0;
  std::vector<double> distances;
  for (const ScanLandmark& landmark : landmarks) {
    const auto index = ibug_index(landmark.name);
    if (landmark.confidence < least_confidence || (index && is_contour(*index))) continue;
    const auto place = scan.rays().closest(landmark.position);
    if (place) distances.push_back(place->distance);
  }
  return distances.empty() ? -1.0 : median(std::move(distances));
}

double misfit_of(const Template& head, const Anchors& anchors) {
  if (anchors.size() < 6) return -1.0;
  const RobustFit fit =
      fit_similarity_robust(head.neutral(anchors.vertices, Eigen::all), anchors.targets, Scaling::free, 1.0);
  return quantile(fit.residuals, 0.5);
}

}  // namespace

ScanFacts facts_of(const scan::CleanReport& report) {
  ScanFacts facts;
  facts.unit_certain = report.units.certain;
  if (report.units.guessed && report.units.mm_per_unit != 1.0) facts.unit = report.units.name;
  facts.inside_out = report.turned_inside_out;
  facts.other_heads = report.other_heads;
  return facts;
}

void add_facts(const FitInput& input, const Fit& fit, ScanFacts& facts) {
  const Prepared& prepared = input.prepared;
  facts.rescaled *= prepared.scale;
  facts.other_heads = std::max(facts.other_heads, prepared.other_faces);
  facts.doubts.insert(facts.doubts.end(), prepared.doubts.begin(), prepared.doubts.end());
  const Eigen::Vector3d top = fit.face_from_scan.rotation.transpose() * Eigen::Vector3d::UnitY();
  facts.tilt_degrees = std::acos(std::clamp(top.y(), -1.0, 1.0)) * 180.0 / M_PI;
  facts.landmark_offset = offset_from(input.scan, prepared.landmarks, input.options.least_confidence);
  facts.landmark_misfit = misfit_of(input.model.head, fit.anchors);
}

}  // namespace vultus::registration
