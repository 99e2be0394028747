#include "register/geometric_landmarks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "register/nonrigid.h"
#include "register/shape_pose.h"

namespace vultus::registration {
namespace {

constexpr double least_score = 0.36, doubtful_score = 0.42,
                 sure_score = 0.5;  // another person's face reaches 0.45 to 0.6, other places 0.35

struct NamedVertex {
  std::string name;
  int vertex;
};

std::vector<NamedVertex> named_vertices(const Template& head) {
  std::vector<NamedVertex> named;
  if (head.ibug68)
    for (int i = 0; i < 68; ++i)
      if ((*head.ibug68)[i] >= 0) named.push_back({ibug_name(i), (*head.ibug68)[i]});
  if (named.size() < 10)
    for (const Landmark& landmark : head.landmarks)
      if (landmark.vertex >= 0) named.push_back({landmark.name, landmark.vertex});
  return named;
}

int nose_tip(const Template& head) {
  for (const char* name : {"ibug.30", "9.3", "nose_tip", "pronasale"})
    if (const auto vertex = landmark_vertex(head, name)) return *vertex;
  throw InputError(
      "the template names no nose tip (\"ibug.30\" or \"9.3\"), which finding a face by shape starts from");
}

// Which unit makes a head of the scan, where cleaning could not tell.
double towards_millimetres(const Points& positions) {
  const double size = bounds(positions).diagonal();
  if (size > 120.0 && size < 1500.0) return 1.0;
  double best = 1.0;
  for (double factor : {10.0, 100.0, 1000.0, 0.1, 0.01, 0.001, 25.4})
    if (std::abs(std::log(factor * size / 420.0)) < std::abs(std::log(best * size / 420.0))) best = factor;
  return best;
}

std::vector<int> face_skin(const RefinedTemplate& model) {
  std::vector<int> skin;
  const bool named = model.topology().has_set("face");
  for (int v = 0; v < model.topology().vertex_count(); ++v)
    if (model.fitted[v] && !named) skin.push_back(v);
  if (named)
    for (int v : model.topology().set("face"))
      if (model.fitted[v]) skin.push_back(v);
  return skin;
}

Points bent_onto(const RefinedTemplate& model, const Points& rest, bool same_person, const ScanSurface& scan) {
  NonrigidOptions options;
  options.fine_spacing = 10.0;
  options.face_spacing = 15.0;
  options.far_spacing = 30.0;
  options.annealing.first_stiffness = 30.0;
  options.annealing.last_stiffness = 0.03;
  options.annealing.first_limit = 10.0;
  options.annealing.stages = 5;
  options.annealing.steps_a_stage = 3;
  options.free_scale = !same_person;
  Points detail(0, 3);
  if (model.head.ibug68) {
    std::vector<int> rows;
    for (int i = 27; i < 68; ++i)
      if ((*model.head.ibug68)[i] >= 0) rows.push_back((*model.head.ibug68)[i]);
    detail = rest(rows, Eigen::all);
  }
  return fit_nonrigid(model.topology(), rest, rest, model.fitted, scan, {}, detail, options).positions;
}

// How well shape alone marks a place: ridges and tips do, smooth skin and seams that open and close do not.
double worth(const std::string& name) {
  const auto index = ibug_index(name);
  if (!index) return 0.3;
  if (is_contour(*index)) return *index >= 7 && *index <= 9 ? 0.25 : 0.1;
  if (*index < 27) return 0.2;  // brows
  if (*index < 36) return 0.6;  // nose
  if (*index == 36 || *index == 39 || *index == 42 || *index == 45) return 0.5;
  if (*index < 48) return 0.35;                                          // lids
  return *index == 48 || *index == 54 ? 0.45 : *index < 60 ? 0.4 : 0.3;  // lips
}

}  // namespace

DetectedLandmarks detect_landmarks_by_shape(const RefinedTemplate& model, const Points& shape, bool same_person,
                                            const Mesh& scan) {
  const double factor = towards_millimetres(scan.positions);
  Mesh in_mm = scan, face;
  in_mm.positions *= factor;
  face.topology = model.loop.refined();
  face.positions = shape;
  const ScanSurface surface(in_mm);
  const auto pose = find_shape_pose(face, face_skin(model), nose_tip(model.head), surface);
  if (!pose || pose->score < least_score)
    throw InputError(
        "no place of the scan has the shape of a face; place landmarks by hand (landmarks/<pose>.json) or check that "
        "the scan shows a face");
  const Points rest = transformed(pose->scan_from_face, shape);
  const Points bent = bent_onto(model, rest, same_person, surface);

  DetectedLandmarks result;
  result.scan_from_face = pose->scan_from_face.rotation;
  result.score = pose->score;
  result.agreement = std::clamp((pose->score - pose->runner_up) / (sure_score - 0.3), 0.0, 1.0);
  std::vector<double> left;
  for (const auto& [name, vertex] : named_vertices(model.head)) {
    const Eigen::Vector3d place = bent.row(vertex);
    const auto near = surface.rays().closest(place, 20.0);
    const double distance = near ? near->distance : 20.0;
    const double confidence = worth(name) * result.agreement / (1.0 + std::pow(distance / 3.0, 2));
    result.points.push_back({name, place / factor, confidence, false});
    left.push_back(distance / factor);
  }
  result.spread = Eigen::Map<Eigen::VectorXd>(left.data(), static_cast<Eigen::Index>(left.size()));
  result.outer_eye_distance = distance_between(result.points, ibug_name(36), ibug_name(45));
  char text[160];
  std::snprintf(text, sizeof text, "landmarks from shape alone: likeness %.2f, the next best place %.2f", pose->score,
                pose->runner_up);
  result.decisions.push_back(text);
  if (pose->score < doubtful_score)
    result.doubts.push_back("what was taken for the face has little of a face's shape, see where its landmarks lie");
  return result;
}

}  // namespace vultus::registration
