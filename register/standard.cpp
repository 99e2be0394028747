#include "register/standard.h"

#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "register/align.h"
#include "register/jaw.h"
#include "register/nonrigid.h"
#include "register/start_warp.h"

namespace vultus::registration {
namespace {

std::string number(double value, const char* format = "%.2f") {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::vector<PointTerm> landmark_terms(const Anchors& anchors) {
  std::vector<PointTerm> terms;
  for (int i = 0; i < anchors.size(); ++i)
    terms.push_back({anchors.vertices[i], anchors.targets.row(i).transpose(), std::sqrt(anchors.confidence[i])});
  return terms;
}

// Eyes, nose and lips, where nodes stand closer.
Points detail(const Template& head, const Points& positions) {
  std::vector<int> rows;
  if (head.ibug68)
    for (int i = 27; i < 68; ++i)
      if ((*head.ibug68)[i] >= 0) rows.push_back((*head.ibug68)[i]);
  return positions(rows, Eigen::all);
}

// Targets of an expression: each vertex of the neutral moved as its sighting moved from the neutral scan to this one,
// so that what the finder gets wrong alike on both does no harm.
Anchors expression_anchors(const Template& head, const Registered& neutral, const Prepared& prepared,
                           double least_confidence) {
  return make_anchors(head, neutral.mesh.positions, prepared.landmarks, &neutral.detected, least_confidence, true);
}

bool is_upper_face(const std::string& name) {
  const auto index = ibug_index(name);
  return !index || (*index >= 27 && *index <= 47);
}

// Rigid motion of the head: landmarks of nose and eyes, then the skin that expressions leave alone.
Similarity head_motion(const Registered& neutral, const Anchors& anchors, const std::vector<int>& rigid,
                       const ScanSurface& scan) {
  std::vector<int> upper;
  for (int i = 0; i < anchors.size(); ++i)
    if (is_upper_face(anchors.names[i])) upper.push_back(i);
  if (upper.size() < 6) {
    upper.clear();
    for (int i = 0; i < anchors.size(); ++i) upper.push_back(i);
  }
  std::vector<int> vertices;
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

Fit fit_standard_neutral(const FitInput& input, Progress& progress) {
  const RefinedTemplate& model = input.model;
  const Template& head = model.head;
  Fit fit;
  fit.anchors = template_anchors(input);
  const Alignment alignment = align_landmarks(head.neutral(fit.anchors.vertices, Eigen::all), fit.anchors.targets,
                                              fit.anchors.confidence, Scaling::free);
  fit.decisions.push_back("template scaled by " + number(alignment.scan_from_template.scale) + ", landmarks then lie " +
                          number(alignment.rms) + " mm off");
  const RbfMap map =
      start_warp(head.neutral, model.fitted_control, fit.anchors, alignment.scan_from_template, input.scan);
  const Points start = model.loop(map(head.neutral));
  const Points rest = transformed(alignment.scan_from_template, model.neutral);
  fit.positions = fit_nonrigid(model.topology(), rest, start, model.fitted, input.scan, landmark_terms(fit.anchors),
                               detail(head, rest), {}, progress)
                      .positions;
  fit.face_from_scan = upright(head, fit.positions, model.neutral);
  return fit;
}

Fit fit_standard_expression(const FitInput& input, const Registered& neutral, Progress& progress) {
  const RefinedTemplate& model = input.model;
  const Template& head = model.head;
  Fit fit;
  const std::vector<int> rigid = model.rigid();
  const Anchors found = expression_anchors(head, neutral, input.prepared, input.options.least_confidence);
  if (found.size() < 6) throw InputError("fewer than 6 landmarks of the scan can be trusted; place some by hand");
  const Similarity scan_from_face = head_motion(neutral, found, rigid, input.scan);
  const Points rest = transformed(scan_from_face, neutral.mesh.positions);
  fit.anchors = plausible_anchors(found, rest);
  if (fit.anchors.size() < found.size())
    fit.decisions.push_back(std::to_string(found.size() - fit.anchors.size()) +
                            " landmarks left out: farther from the neutral than skin can move");
  const JawOpening jaw = find_jaw_opening(head, model.topology(), rest, model.fitted, fit.anchors, input.scan);
  if (jaw.angle > 0.0) fit.decisions.push_back("jaw open by " + number(jaw.angle * 180.0 / M_PI, "%.0f") + " degrees");
  std::vector<PointTerm> pulls = landmark_terms(fit.anchors);
  pulls.insert(pulls.end(), jaw.terms.begin(), jaw.terms.end());
  NonrigidOptions nonrigid;
  nonrigid.free_scale = false;
  // The same person: landmarks hardly lie, and the shape they give is kept against sliding along the surface.
  nonrigid.first_stiffness = 1.0;
  nonrigid.last_stiffness = 0.1;
  nonrigid.first_landmarks = 5.0;
  nonrigid.last_landmarks = 0.5;
  nonrigid.landmark_steps = 6;
  fit.positions = fit_nonrigid(model.topology(), rest, rest, model.fitted, input.scan, pulls, detail(head, rest),
                               nonrigid, progress)
                      .positions;
  fit.face_from_scan = fit_similarity_robust(fit.positions(rigid, Eigen::all),
                                             neutral.mesh.positions(rigid, Eigen::all), Scaling::fixed, 0.2)
                           .target_from_source;
  return fit;
}

}  // namespace vultus::registration
