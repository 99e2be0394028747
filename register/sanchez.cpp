#include "register/sanchez.h"

#include <cmath>

#include "core/number_text.h"
#include "register/align.h"
#include "register/control_surface.h"
#include "register/energy_registration.h"
#include "register/expression_start.h"
#include "register/fill.h"
#include "register/jaw.h"
#include "register/project.h"
#include "register/smooth_projection.h"
#include "register/start_warp.h"
#include "register/unfold.h"

namespace vultus::registration {
namespace {

// Weights of eq. 17. Towards another person the template's shape is held more firmly than one's own neutral is in an
// expression: landmarks found on a neutral mislead by millimetres along the skin, which only the shape can tell.
constexpr EnergyWeights another_person{1.0, 10.0, 100.0};
constexpr EnergyWeights same_person{1.0, 2.0, 30.0};

std::string in_words(const EnergyRegistration& energy, int controls) {
  return "energy over " + std::to_string(controls) + " control points: distance " + number(energy.initial.distance) +
         " to " + number(energy.final.distance) + " mm, strain " + number(energy.initial.strain) + " to " +
         number(energy.final.strain) + " mm, in " + std::to_string(energy.steps) + " steps; " + energy.stopped;
}

/// The part both kinds of scan share: `reference` is the shape to keep, `start` the control points' start.
Points fitted_by_energy(const FitInput& input, const SkinControls& controls, const Points& reference,
                        const Points& start, const EnergyWeights& weights, Fit& fit, Progress& progress) {
  const RefinedTemplate& model = input.model;
  PlanarBoneOptions reach;
  reach.everywhere = true;
  const PlanarBones bones(controls.on(reference), reference, controls.masks, reach);
  EnergyOptions terms;
  terms.weights = weights;
  RegistrationEnergy energy(model.topology(), reference, bones, model.fitted, input.scan, terms);
  EnergyRegistrationOptions options;
  options.solver = input.options.energy_solver;
  const EnergyRegistration found = minimize_energy(energy, start, options, progress);
  fit.decisions.push_back(in_words(found, static_cast<int>(start.rows())));
  // What no scan shows, such as the inside of the lips, follows the skin it hangs on rather than any bone near it.
  const Points moved = bones(found.control) - reference;
  Points positions = reference + fill_smoothly(model.topology(), reference, moved, model.fitted);
  positions = unfolded(model.topology(), reference, positions);
  positions = project_smoothly(model.topology(), positions, model.fitted, input.scan);
  positions = unfolded(model.topology(), reference, positions);
  return positions;
}

// RBF warp through the landmarks (eqs. 13–16), then cylindrical projection (§6).
Points neutral_start(const FitInput& input, const Anchors& anchors, const Similarity& scan_from_template) {
  const RefinedTemplate& model = input.model;
  const RbfMap map = start_warp(model.head.neutral, model.fitted_control, anchors, scan_from_template, input.scan,
                                RbfKernel::inverse_multiquadric);
  const HeadAxis axis = head_axis(model.head.neutral, model.fitted_control, scan_from_template);
  ProjectOptions projection;
  projection.max_displacement = input.options.displacement_limit;
  return project_cylindrically(model.topology(), model.loop(map(model.head.neutral)), model.fitted, input.scan,
                               axis.point, axis.direction, projection)
      .positions;
}

// Control points moved as landmarks and jaw move them; those between follow smoothly over the control surface.
Points moved_controls(const SkinControls& controls, const Points& rest, const Anchors& anchors,
                      const std::vector<PointTerm>& jaw) {
  const int count = static_cast<int>(controls.vertices.size());
  Points displacement = Points::Zero(count, 3);
  // Skin far from every landmark stays with the skull.
  Eigen::VectorXd weight = Eigen::VectorXd::Constant(count, 0.02);
  for (int c = 0; c < count; ++c) {
    double nearest = 8.0;  // mm: the jaw's terms stand closer than that on the chin
    for (const PointTerm& term : jaw) {
      const double distance = (rest.row(term.vertex) - rest.row(controls.vertices[c])).norm();
      if (distance > nearest) continue;
      nearest = distance;
      displacement.row(c) = term.target.transpose() - rest.row(term.vertex);
      weight[c] = 1.0;
    }
    for (int i = 0; i < anchors.size(); ++i) {
      if (anchors.vertices[i] != controls.vertices[c]) continue;
      displacement.row(c) = anchors.targets.row(i) - rest.row(anchors.vertices[i]);
      weight[c] = 20.0 * anchors.confidence[i];
    }
  }
  return rest(controls.vertices, Eigen::all) +
         fit_smoothly(*Topology::from_triangles(count, controls.triangles), displacement, weight, 1.0);
}

}  // namespace

Fit fit_sanchez_neutral(const FitInput& input, Progress& progress) {
  const RefinedTemplate& model = input.model;
  Fit fit;
  fit.anchors = template_anchors(input);
  const Alignment alignment = align_landmarks(model.head.neutral(fit.anchors.vertices, Eigen::all), fit.anchors.targets,
                                              fit.anchors.confidence, Scaling::free);
  fit.decisions.push_back("template scaled by " + number(alignment.scan_from_template.scale) + ", landmarks then lie " +
                          number(alignment.rms) + " mm off");
  const Similarity& scan_from_template = alignment.scan_from_template;
  const Points reference = transformed(scan_from_template, model.neutral);
  const Points from = neutral_start(input, fit.anchors, scan_from_template);
  const SkinControls controls = make_controls(model.head, model.topology(), model.neutral, model.fitted);
  fit.positions =
      fitted_by_energy(input, controls, reference, from(controls.vertices, Eigen::all), another_person, fit, progress);
  carry_components(model.topology(), reference, model.fitted, true, fit.positions);
  fit.face_from_scan = upright(model.head, fit.positions, model.neutral);
  return fit;
}

Fit fit_sanchez_expression(const FitInput& input, const Registered& neutral, Progress& progress) {
  const RefinedTemplate& model = input.model;
  ExpressionStart start = start_expression(input, neutral);
  Fit fit;
  fit.decisions = start.decisions;
  const JawOpening jaw =
      find_jaw_opening(model.head, model.topology(), start.rest, model.fitted, start.anchors, input.scan);
  if (jaw.angle > 0.0)
    fit.decisions.push_back("jaw open by " + std::to_string(std::lround(jaw.angle * 180.0 / M_PI)) + " degrees");
  start.anchors = agreeing_anchors(model.head, start.anchors, start.rest, jaw);
  const SkinControls controls = make_controls(model.head, model.topology(), model.neutral, model.fitted);
  const Points from = moved_controls(controls, start.rest, start.anchors, jaw.terms);
  fit.anchors = std::move(start.anchors);
  fit.positions = fitted_by_energy(input, controls, start.rest, from, same_person, fit, progress);
  carry_components(model.topology(), start.rest, model.fitted, false, fit.positions);
  fit.face_from_scan = back_to_neutral(start.steady, neutral, fit.positions);
  return fit;
}

}  // namespace vultus::registration
