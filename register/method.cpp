#include "register/method.h"

#include "core/error.h"
#include "register/orientation.h"

namespace vultus::registration {

Anchors template_anchors(const FitInput& input) {
  const Template& head = input.model.head;
  const ScanLandmarks* seen =
      input.prepared.automatic && !input.prepared.coloured ? input.preparation.template_sighting() : nullptr;
  Anchors anchors = make_anchors(head, head.neutral, input.prepared.landmarks, seen, input.options.least_confidence);
  if (anchors.size() < 6)
    throw InputError("only " + std::to_string(anchors.size()) +
                     " landmarks of the scan can be trusted, 6 are needed; place some by hand (landmarks/<pose>.json)");
  return anchors;
}

Similarity upright(const Template& head, const Points& positions, const Points& reference) {
  const auto pose = orientation_points(head, positions), model = orientation_points(head, reference);
  if (pose && model) return normalize_orientation(*pose, *model);
  return fit_similarity_robust(positions, reference, Scaling::fixed, 1.0).target_from_source;
}

}  // namespace vultus::registration
