#include "register/expression_start.h"

#include "core/error.h"
#include "register/align.h"
#include "register/lip_opening.h"

namespace vultus::registration {
namespace {

bool is_upper_face(const std::string& name) {
  const auto index = ibug_index(name);
  return !index || (*index >= 27 && *index <= 47);
}

Similarity head_motion(const Registered& neutral, const Anchors& anchors, const std::vector<int>& rigid,
                       const ScanSurface& scan) {
  std::vector<int> upper, vertices;
  for (int i = 0; i < anchors.size(); ++i)
    if (is_upper_face(anchors.names[i])) upper.push_back(i);
  if (upper.size() < 6) {
    upper.clear();
    for (int i = 0; i < anchors.size(); ++i) upper.push_back(i);
  }
  for (int i : upper) vertices.push_back(anchors.vertices[i]);
  const Alignment first =
      align_landmarks(neutral.mesh.positions(vertices, Eigen::all), anchors.targets(upper, Eigen::all),
                      anchors.confidence(upper), Scaling::fixed);
  RigidRefinement refinement;
  refinement.first_limit = 12.0;
  return align_surface(*neutral.mesh.topology, neutral.mesh.positions, rigid, scan, first.scan_from_template,
                       Scaling::fixed, refinement)
      .scan_from_template;
}

}  // namespace

ExpressionStart start_expression(const FitInput& input, const Registered& neutral) {
  const Anchors found = make_anchors(input.model.head, neutral.mesh.positions, input.prepared.landmarks,
                                     &neutral.detected, input.options.least_confidence, true);
  if (found.size() < 6) throw InputError("fewer than 6 landmarks of the scan can be trusted; place some by hand");
  ExpressionStart start;
  start.scan_from_face = head_motion(neutral, found, input.model.rigid(), input.scan);
  start.rest = transformed(start.scan_from_face, neutral.mesh.positions);
  start.anchors = plausible_anchors(found, start.rest);
  if (start.anchors.size() < found.size())
    start.decisions.push_back(std::to_string(found.size() - start.anchors.size()) +
                              " landmarks left out: farther from the neutral than skin can move");
  start.anchors = with_inner_lips(input.model.head, start.anchors, start.rest, input.scan.rays());
  return start;
}

Similarity back_to_neutral(const RefinedTemplate& model, const Registered& neutral, const Points& positions) {
  const std::vector<int> rigid = model.rigid();
  return fit_similarity_robust(positions(rigid, Eigen::all), neutral.mesh.positions(rigid, Eigen::all), Scaling::fixed,
                               0.2)
      .target_from_source;
}

}  // namespace vultus::registration
