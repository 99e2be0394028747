#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "register/detect_landmarks.h"
#include "register/landmarks.h"
#include "register/refined_template.h"
#include "register/register_options.h"

namespace vultus::registration {

class FaceFinder;

/// What is known of one scan before any fitting.
struct Prepared {
  Mesh scan;                           ///< mm
  double scale = 1.0;                  ///< scan in mm from the scan as given
  ScanLandmarks landmarks;             ///< scan frame, mm
  bool coloured = false;               ///< the finder saw colour
  bool automatic = false;              ///< landmarks were found rather than placed
  std::vector<std::string> decisions;  ///< in words
  int other_faces = 0;                 ///< seen in the scan beside the one that was taken
  std::vector<std::string> doubts;     ///< about the landmarks, in words: reasons for a warning
};

/// Finds the landmarks of scans and of the template as the same finder sees it. Const methods may run at once.
class Preparation {
 public:
  /// Both must outlive this. `options.finder` is loaded on first need when null.
  Preparation(const RefinedTemplate& model, const RegisterOptions& options);

  /// Landmarks given, found, or both, and the unit as the eyes tell it. For the method `zhu`, major points given by
  /// hand bring the minor ones with them (§4.2). `neutral` (refined topology, mm) is the same person's, where it is
  /// known: shape alone then finds expressions better. Throws `InputError` when no face is found, `ToolError` without
  /// the model where only pictures are allowed.
  Prepared operator()(const Mesh& scan, const std::optional<ScanLandmarks>& given,
                      const Points* neutral = nullptr) const;
  /// What the finder makes of the template's bare shape; null when it sees no face there or there is no finder.
  const ScanLandmarks* template_sighting() const;

 private:
  const FaceFinder& finder() const;
  DetectedLandmarks found(const Mesh& scan, const Points* neutral) const;

  const RefinedTemplate& model_;
  const RegisterOptions& options_;
  mutable std::mutex finder_lock_;
  mutable std::once_flag sighting_once_;
  mutable std::shared_ptr<const FaceFinder> finder_;
  mutable std::optional<DetectedLandmarks> sighting_;
};

}  // namespace vultus::registration
