#include "register/prepare.h"

#include <algorithm>

#include "core/error.h"
#include "core/number_text.h"
#include "core/statistics.h"
#include "register/anchors.h"
#include "register/face_finder.h"
#include "register/geometric_landmarks.h"
#include "register/minor_landmarks.h"
#include "scan/thin.h"

namespace vultus::registration {
namespace {

// Enough points to go on without looking for more.
constexpr std::size_t enough_given = 10;
// Share of the views that see a face from where it faces, or the margin of its shape over the next best place.
constexpr double least_agreement = 0.5;
// A nose hardly changes with the expression: where views disagree about it, a gaping mouth was taken for something
// else.
constexpr double least_nose_confidence = 0.4;

double nose_confidence(const ScanLandmarks& points) {
  std::vector<double> found;
  for (const ScanLandmark& point : points)
    if (const auto ibug = ibug_index(point.name); ibug && *ibug >= 27 && *ibug <= 35) found.push_back(point.confidence);
  if (found.empty()) return 0.0;
  return median(std::move(found));
}

// What a first look needs of a scan: pictures of the face resolve a millimetre. Where an image tells more than the
// surface, the scan is looked at as it is.
Mesh coarse(const Mesh& scan) {
  constexpr Eigen::Index enough_triangles = 150'000;
  const bool pictured = !scan.texture.empty() && scan.topology->has_uvs() && !scan.has_colours();
  if (pictured || scan.topology->triangles().rows() <= enough_triangles) return scan;
  const double cell = scan.has_colours() ? 0.8 : 1.2;  // mm
  // The unit may be another than it seems; a head's size tells what a millimetre is.
  return scan::thinned(scan, std::min(cell, 0.003 * bounds(scan.positions).diagonal()));
}

}  // namespace

Preparation::Preparation(const RefinedTemplate& model, const RegisterOptions& options)
    : model_(model), options_(options), finder_(options.finder) {}

const FaceFinder& Preparation::finder() const {
  const std::lock_guard<std::mutex> lock(finder_lock_);
  if (!finder_) finder_ = std::make_shared<const FaceFinder>();
  return *finder_;
}

const ScanLandmarks* Preparation::template_sighting() const {
  std::call_once(sighting_once_, [&] {
    try {
      Mesh shape;
      shape.topology = model_.loop.refined();
      shape.positions = model_.neutral;
      sighting_ = detect_landmarks(shape, finder());
    } catch (const InputError&) {
    } catch (const ToolError&) {
    }
  });
  return sighting_ ? &sighting_->points : nullptr;
}

DetectedLandmarks Preparation::found(const Mesh& whole, const Points* neutral) const {
  const Mesh scan = coarse(whole);
  const auto by_shape = [&] {
    return detect_landmarks_by_shape(model_, neutral ? *neutral : model_.neutral, neutral != nullptr, scan);
  };
  const bool can_picture = model_.head.ibug68.has_value();
  if (options_.landmarks_by == LandmarkFinder::pictures && !can_picture)
    throw InputError("the template names no 68-point landmarks, which are what dlib finds; let shape find its own");
  if (options_.landmarks_by == LandmarkFinder::shape || !can_picture) return by_shape();
  if (options_.landmarks_by == LandmarkFinder::pictures) return detect_landmarks(scan, finder());
  std::string why;
  try {
    const DetectedLandmarks pictured = detect_landmarks(scan, finder());
    if (nose_confidence(pictured.points) >= least_nose_confidence) return pictured;
    why = "views of the scan disagree where the nose is";
  } catch (const InputError&) {
    why = "pictures of the scan show no face";
  } catch (const ToolError&) {
    why = "dlib's model is not there (apt install libdlib-data)";
  }
  DetectedLandmarks result = by_shape();
  result.decisions.front() = why + ": " + result.decisions.front();
  return result;
}

Prepared Preparation::operator()(const Mesh& scan, const std::optional<ScanLandmarks>& given,
                                 const Points* neutral) const {
  Prepared prepared;
  prepared.scan = scan;
  if (given && given->size() >= enough_given) {
    prepared.landmarks = *given;
    // Landmarks found earlier keep their confidence below one and the finder's bias.
    prepared.automatic = std::none_of(given->begin(), given->end(), [](const auto& l) { return l.confidence >= 1.0; });
    prepared.decisions.push_back(std::to_string(given->size()) + " landmarks given");
    if (options_.method == Method::zhu && are_major_landmarks(model_.head, *given)) {
      const ScanLandmarks minor = place_minor_landmarks(model_.head, *given, ScanSurface(scan));
      prepared.landmarks.insert(prepared.landmarks.end(), minor.begin(), minor.end());
      prepared.decisions.push_back(std::to_string(minor.size()) + " minor ones placed by them (Zhu 4.2)");
    }
    return prepared;
  }
  const DetectedLandmarks found = this->found(scan, neutral);
  prepared.automatic = true;
  prepared.coloured = found.coloured;
  prepared.landmarks = given ? overridden(found.points, *given) : found.points;
  prepared.decisions = found.decisions;
  prepared.other_faces = found.other_faces;
  prepared.doubts = found.doubts;
  if (found.agreement < least_agreement)
    prepared.doubts.push_back("the face was hard to find (agreement " + number(found.agreement) +
                              " of 1); see where "
                              "its landmarks lie");
  if (given) prepared.decisions.push_back(std::to_string(given->size()) + " of the landmarks given by hand");
  prepared.scale = unit_correction(found.outer_eye_distance);
  if (prepared.scale != 1.0) {
    prepared.scan.positions *= prepared.scale;
    for (ScanLandmark& landmark : prepared.landmarks) landmark.position *= prepared.scale;
    prepared.decisions.push_back("scan scaled by " + number(prepared.scale, "%g") + ": its outer eye corners lay " +
                                 number(found.outer_eye_distance, "%.3g") + " mm apart");
  }
  return prepared;
}

}  // namespace vultus::registration
