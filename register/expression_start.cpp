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

// Those of `vertices` that the scan shows when the neutral lies as `at` says.
std::vector<int> shown(const std::vector<int>& vertices, const Registered& neutral, const Similarity& at,
                       const ScanSurface& scan) {
  const Points positions = transformed(at, neutral.mesh.positions);
  const Points normals = vertex_normals(*neutral.mesh.topology, positions);
  std::vector<int> found;
  for (int v : vertices)
    if (scan.nearest(positions.row(v), normals.row(v), 12.0, 0.6)) found.push_back(v);
  return found;
}

// Skin that tells how the head has moved: what expressions leave alone most, where the scan shows enough of it, else
// all above the lips.
std::vector<int> steady_skin(const RefinedTemplate& model, const Registered& neutral, const Similarity& at,
                             const ScanSurface& scan) {
  const std::vector<int> rigid = model.rigid();
  std::vector<int> steady = shown(rigid, neutral, at, scan);
  if (3 * steady.size() < rigid.size()) steady = shown(model.above_lips(), neutral, at, scan);
  return steady.size() < 50 ? rigid : steady;
}

Similarity by_landmarks(const Registered& neutral, const Anchors& anchors) {
  std::vector<int> upper, vertices;
  for (int i = 0; i < anchors.size(); ++i)
    if (is_upper_face(anchors.names[i])) upper.push_back(i);
  if (upper.size() < 6) {
    upper.clear();
    for (int i = 0; i < anchors.size(); ++i) upper.push_back(i);
  }
  for (int i : upper) vertices.push_back(anchors.vertices[i]);
  return align_landmarks(neutral.mesh.positions(vertices, Eigen::all), anchors.targets(upper, Eigen::all),
                         anchors.confidence(upper), Scaling::fixed)
      .scan_from_template;
}

// Steady skin first, then all of it: most of a face stays with the skull in most poses.
Similarity head_motion(const RefinedTemplate& model, const Registered& neutral, const Similarity& first,
                       const std::vector<int>& steady, const ScanSurface& scan) {
  const Topology& topology = *neutral.mesh.topology;
  RigidRefinement refinement;
  refinement.first_limit = 12.0;
  const Similarity skull =
      align_surface(topology, neutral.mesh.positions, steady, scan, first, Scaling::fixed, refinement)
          .scan_from_template;
  std::vector<int> skin;
  for (int v = 0; v < topology.vertex_count(); v += 2)
    if (model.fitted[v]) skin.push_back(v);
  refinement.first_limit = 3.0;
  refinement.last_limit = 0.7;
  return align_surface(topology, neutral.mesh.positions, skin, scan, skull, Scaling::fixed, refinement)
      .scan_from_template;
}

}  // namespace

ExpressionStart start_expression(const FitInput& input, const Registered& neutral) {
  const Anchors found = make_anchors(input.model.head, neutral.mesh.positions, input.prepared.landmarks,
                                     &neutral.detected, input.options.least_confidence, true);
  if (found.size() < 6) throw InputError("fewer than 6 landmarks of the scan can be trusted; place some by hand");
  ExpressionStart start;
  const Similarity first = by_landmarks(neutral, found);
  start.steady = steady_skin(input.model, neutral, first, input.scan);
  start.scan_from_face = head_motion(input.model, neutral, first, start.steady, input.scan);
  start.rest = transformed(start.scan_from_face, neutral.mesh.positions);
  start.anchors = plausible_anchors(found, start.rest);
  if (start.anchors.size() < found.size())
    start.decisions.push_back(std::to_string(found.size() - start.anchors.size()) +
                              " landmarks left out: farther from the neutral than skin can move");
  start.anchors = with_inner_lips(input.model.head, start.anchors, start.rest, input.scan.rays());
  return start;
}

Similarity back_to_neutral(const std::vector<int>& steady, const Registered& neutral, const Points& positions) {
  return fit_similarity_robust(positions(steady, Eigen::all), neutral.mesh.positions(steady, Eigen::all),
                               Scaling::fixed, 0.2)
      .target_from_source;
}

}  // namespace vultus::registration
