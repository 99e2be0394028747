#include "register/standard.h"

#include <cmath>

#include "core/number_text.h"
#include "register/align.h"
#include "register/appearance.h"
#include "register/closed_lids.h"
#include "register/expression_start.h"
#include "register/flow_alignment.h"
#include "register/jaw.h"
#include "register/nonrigid.h"
#include "register/seals.h"
#include "register/settled_skin.h"
#include "register/start_warp.h"
#include "register/strayed_features.h"

namespace vultus::registration {
namespace {

// Found landmarks are millimetres off and only start the fit; those placed by hand hold.
Pulls landmark_pulls(const Anchors& anchors) {
  Pulls pulls;
  for (int i = 0; i < anchors.size(); ++i) {
    const Eigen::Vector3d target = anchors.targets.row(i);
    if (anchors.confidence[i] >= 1.0) pulls.kept.push_back({anchors.vertices[i], target, 0.3});
    pulls.annealed.push_back({anchors.vertices[i], target, std::sqrt(anchors.confidence[i])});
  }
  return pulls;
}

// Eyes, nose and lips, where nodes stand closer.
Points detail(const Template& head, const Points& positions) {
  std::vector<int> rows;
  if (head.ibug68)
    for (int i = 27; i < 68; ++i)
      if ((*head.ibug68)[i] >= 0) rows.push_back((*head.ibug68)[i]);
  return positions(rows, Eigen::all);
}

std::vector<int> fitted_face(const RefinedTemplate& model) {
  std::vector<int> vertices;
  auto add = [&](int v) {
    if (model.fitted[v]) vertices.push_back(v);
  };
  if (model.topology().has_set("face"))
    for (int v : model.topology().set("face")) add(v);
  else
    for (int v = 0; v < model.topology().vertex_count(); ++v) add(v);
  return vertices;
}

// Pairs of rims that touch in the scan; those that stand open in it are left to the data.
std::vector<std::pair<int, int>> sealed_pairs(const Template& head, const Points& positions, const ScanSurface& scan) {
  std::vector<std::pair<int, int>> pairs;
  for (const Seal& seal : find_seals(head, positions, scan))
    if (seal.scan_gap >= 0.0 && seal.scan_gap <= sealed_groove)
      pairs.insert(pairs.end(), seal.pairs.begin(), seal.pairs.end());
  return pairs;
}

// Rounds of flow, and what one vertex's sighting weighs against its data: colour marks the skin itself, relief changes
// with the expression.
struct FlowTrust {
  int rounds;
  double weight;
};
FlowTrust flow_trust(bool coloured) { return coloured ? FlowTrust{2, 1.0} : FlowTrust{1, 0.05}; }

// The person's own look, carried along by the fit and found again on the scan, says where skin has gone that has no
// landmark.
void follow_look(const FitInput& input, const Registered& neutral, const Similarity& scan_from_face, Pulls pulls,
                 NonrigidFit& fit, Progress& progress) {
  if (!neutral.look) return;
  const RefinedTemplate& model = input.model;
  const Appearance look(input.prepared.scan);
  const std::vector<int> face = fitted_face(model);
  const FlowTrust trust = flow_trust(look.coloured() && neutral.look->coloured());
  Annealing annealing;
  annealing.first_stiffness = 0.01;
  annealing.last_stiffness = 0.0005;
  annealing.first_limit = 5.0;
  annealing.first_points = annealing.last_points = trust.weight * fit.unit();
  annealing.stages = 3;
  for (int round = 0; round < trust.rounds; ++round) {
    pulls.annealed =
        flow_targets(model.topology(), face, {neutral.on_look, *neutral.look}, {fit.positions(), look}, scan_from_face);
    pulls.touching = sealed_pairs(model.head, fit.positions(), input.scan);
    fit.anneal(pulls, annealing, progress);
  }
}

// The template's size and place by all of its skin: landmarks seen in pictures are off alike and would tell another.
Similarity head_on_scan(const RefinedTemplate& model, const Similarity& by_landmarks, const ScanSurface& scan) {
  std::vector<int> skin;
  for (int v = 0; v < model.topology().vertex_count(); v += 3)
    if (model.fitted[v]) skin.push_back(v);
  const Alignment found = align_surface(model.topology(), model.neutral, skin, scan, by_landmarks, Scaling::free);
  return found.rms < 0.0 ? by_landmarks : found.scan_from_template;
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
  const Points rest = transformed(head_on_scan(model, alignment.scan_from_template, input.scan), model.neutral);
  NonrigidOptions options;
  // Chosen on neutrals of other people whose true vertices are known; an actor's own expressions fit closer.
  options.rigidity = 0.05;
  options.annealing.first_stiffness = 3.0;
  options.annealing.last_stiffness = 0.001;
  options.annealing.last_points = 0.0003;
  NonrigidFit nonrigid(model.topology(), rest, start, model.fitted, input.scan, detail(head, rest), options);
  Pulls pulls = landmark_pulls(fit.anchors);
  nonrigid.anneal(pulls, options.annealing, progress);
  const auto again = [&](double stiffness, int stages) {
    Annealing ending = options.annealing;
    ending.first_stiffness = stiffness;
    ending.first_limit = ending.last_limit;
    ending.first_points = ending.last_points;
    ending.stages = stages;
    nonrigid.anneal(pulls, ending, progress);
  };
  const std::vector<PointTerm> strayed = strayed_features(fit.anchors, nonrigid.positions(), input.prepared.coloured);
  for (PointTerm term : strayed) {
    term.weight *= 0.05;  // of one node's data: firm enough against the surface, on which features slide freely
    pulls.kept.push_back(term);
  }
  if (!strayed.empty()) again(0.01, 3);
  pulls.touching = sealed_pairs(head, nonrigid.positions(), input.scan);
  if (!pulls.touching.empty()) again(0.002, 1);
  fit.positions = nonrigid.finished().positions;
  fit.face_from_scan = upright(head, fit.positions, model.neutral);
  fit.look = std::make_shared<const Appearance>(input.prepared.scan);
  return fit;
}

Fit fit_standard_expression(const FitInput& input, const Registered& neutral, Progress& progress) {
  const RefinedTemplate& model = input.model;
  const Template& head = model.head;
  ExpressionStart start = start_expression(input, neutral);
  Fit fit;
  fit.decisions = std::move(start.decisions);
  fit.anchors = std::move(start.anchors);
  const JawOpening jaw = find_jaw_opening(head, model.topology(), start.rest, model.fitted, fit.anchors, input.scan);
  if (jaw.drop > 0.0)
    fit.decisions.push_back("chin moved by " + number(jaw.drop, "%.0f") + " mm, turned by " +
                            number(jaw.angle * 180.0 / M_PI, "%.0f") + " degrees");
  fit.anchors = agreeing_anchors(head, fit.anchors, start.rest, jaw);
  Pulls pulls = landmark_pulls(fit.anchors);
  pulls.annealed.insert(pulls.annealed.end(), jaw.terms.begin(), jaw.terms.end());
  const LidClosing closing = find_lid_closing(head, model.fitted, start.rest, input.scan);
  pulls.annealed.insert(pulls.annealed.end(), closing.terms.begin(), closing.terms.end());
  pulls.kept.insert(pulls.kept.end(), closing.terms.begin(), closing.terms.end());
  for (const std::string& lids : closing.lids) fit.decisions.push_back(lids + " are closed: led to where they meet");
  NonrigidOptions options;
  options.free_scale = false;
  options.rigidity = 1.0;
  options.annealing.first_stiffness = 1.0;
  options.annealing.last_stiffness = 0.0002;
  options.annealing.first_points = 5.0;
  options.annealing.last_points = 0.005;
  std::vector<PointTerm> opening = pulls.annealed;
  for (PointTerm& pull : opening) pull.weight *= 2.0 * options.annealing.first_points;
  NonrigidFit nonrigid(model.topology(), start.rest, start.rest, model.fitted, input.scan, detail(head, start.rest),
                       options);
  for (PointTerm settled : settled_skin(model, start.rest, fit.anchors, input.scan)) {
    settled.weight *= 0.3 * nonrigid.unit();
    pulls.kept.push_back(settled);
  }
  nonrigid.follow(opening, 0.1 * options.annealing.first_stiffness, 6);
  nonrigid.anneal(pulls, options.annealing, progress);
  follow_look(input, neutral, start.scan_from_face, pulls, nonrigid, progress);
  fit.positions = nonrigid.finished().positions;
  fit.face_from_scan = back_to_neutral(start.steady, neutral, fit.positions);
  return fit;
}

}  // namespace vultus::registration
