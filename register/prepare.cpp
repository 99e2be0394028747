#include "register/prepare.h"

#include <algorithm>
#include <cstdio>

#include "core/error.h"
#include "register/anchors.h"
#include "register/face_finder.h"

namespace vultus::registration {
namespace {

// Enough points to go on without looking for more.
constexpr std::size_t enough_given = 10;

std::string number(double value, const char* format = "%.2f") {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

}  // namespace

Preparation::Preparation(const Template& head, Mesh shape, std::shared_ptr<const FaceFinder> finder)
    : head_(head), shape_(std::move(shape)), finder_(std::move(finder)) {}

const FaceFinder& Preparation::finder() const {
  std::call_once(finder_once_, [&] {
    if (!finder_) finder_ = std::make_shared<const FaceFinder>();
  });
  return *finder_;
}

const ScanLandmarks* Preparation::template_sighting() const {
  std::call_once(sighting_once_, [&] {
    try {
      sighting_ = detect_landmarks(shape_, finder());
    } catch (const InputError&) {
    }
  });
  return sighting_ ? &sighting_->points : nullptr;
}

Prepared Preparation::operator()(const Mesh& scan, const std::optional<ScanLandmarks>& given) const {
  Prepared prepared;
  prepared.scan = scan;
  if (given && given->size() >= enough_given) {
    prepared.landmarks = *given;
    // Landmarks found earlier keep their confidence below one and the finder's bias.
    prepared.automatic = std::none_of(given->begin(), given->end(), [](const auto& l) { return l.confidence >= 1.0; });
    prepared.decisions.push_back(std::to_string(given->size()) + " landmarks given");
    return prepared;
  }
  if (!head_.ibug68)
    throw InputError("the template names no 68-point landmarks, so none can be found on the scan; give at least " +
                     std::to_string(enough_given) + " of its own landmarks by file");
  const DetectedLandmarks found = detect_landmarks(scan, finder());
  prepared.automatic = true;
  prepared.coloured = found.coloured;
  prepared.landmarks = given ? overridden(found.points, *given) : found.points;
  prepared.decisions = found.decisions;
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
