#include "register/consistent.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "core/error.h"
#include "core/files.h"
#include "core/neighbours.h"
#include "core/rbf.h"
#include "register/align.h"
#include "register/anchors.h"
#include "register/fill.h"
#include "register/jaw.h"
#include "register/orientation.h"
#include "register/project.h"
#include "register/subdivide.h"

namespace vultus::registration {
namespace {

// Enough points to go on without looking for more.
constexpr std::size_t enough_given = 10;

std::string number(double value, const char* format = "%.2f") {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

/// What was found out about one scan before any fitting.
struct Prepared {
  Mesh scan;                // mm
  double scale = 1.0;       // scan in mm from the scan as given
  ScanLandmarks landmarks;  // scan frame, mm
  bool coloured = false, automatic = false;
  std::vector<std::string> decisions;
};

// Template vertices far from every anchor, so that the warp stays put where no landmark says anything.
std::vector<int> support_vertices(const Points& positions, const std::vector<bool>& fitted, const Points& anchors,
                                  double spacing) {
  std::vector<int> chosen;
  Points taken = anchors;
  for (int v = 0; v < positions.rows(); ++v) {
    if (!fitted[v] || (taken.rowwise() - positions.row(v)).rowwise().squaredNorm().minCoeff() < spacing * spacing)
      continue;
    chosen.push_back(v);
    taken.conservativeResize(taken.rows() + 1, 3);
    taken.bottomRows<1>() = positions.row(v);
  }
  return chosen;
}

struct HeadAxis {
  Eigen::Vector3d point, direction;
};

// Zhu §4.5.2: through the head's centre, parallel to y.
HeadAxis head_axis(const Points& neutral, const std::vector<bool>& fitted, const Similarity& scan_from_template) {
  std::vector<int> skin;
  for (int v = 0; v < neutral.rows(); ++v)
    if (fitted[v]) skin.push_back(v);
  const Eigen::Vector3d centre = bounds(neutral(skin, Eigen::all)).centre();
  return {scan_from_template * centre, scan_from_template.rotation * Eigen::Vector3d::UnitY()};
}

// RBF warp of template space onto the scan (Zhu §4.3) through the anchors; where none is near, through template points
// moved by the alignment and set onto the scan by a ray (Zhu §4.2).
RbfMap warp(const Points& vertices, const std::vector<bool>& fitted, const Anchors& anchors,
            const Similarity& scan_from_template, const ScanSurface& scan) {
  const Points sources = vertices(anchors.vertices, Eigen::all);
  const std::vector<int> support = support_vertices(vertices, fitted, sources, 35.0);
  const HeadAxis axis = head_axis(vertices, fitted, scan_from_template);
  Points from(sources.rows() + support.size(), 3), to(from.rows(), 3);
  from.topRows(sources.rows()) = sources;
  to.topRows(sources.rows()) = anchors.targets;
  for (std::size_t k = 0; k < support.size(); ++k) {
    const Eigen::Vector3d moved = scan_from_template * Eigen::Vector3d(vertices.row(support[k]));
    Eigen::Vector3d radial = moved - axis.point;
    radial -= axis.direction * axis.direction.dot(radial);
    from.row(sources.rows() + k) = vertices.row(support[k]);
    to.row(sources.rows() + k) = moved;
    if (radial.norm() < 1.0) continue;
    if (const auto hit = scan.along(moved, radial.normalized(), radial.normalized(), 15.0, 0.3))
      to.row(sources.rows() + k) = hit->position;
  }
  return RbfMap(from, to);
}

std::vector<PointTerm> landmark_terms(const Anchors& anchors) {
  std::vector<PointTerm> terms;
  for (int i = 0; i < anchors.size(); ++i)
    terms.push_back({anchors.vertices[i], anchors.targets.row(i).transpose(), std::sqrt(anchors.confidence[i])});
  return terms;
}

// Skin that expressions leave alone most: the set "rigid", else everything fitted.
std::vector<int> rigid_vertices(const Topology& topology, const std::vector<bool>& fitted) {
  std::vector<int> vertices;
  if (topology.has_set("rigid"))
    for (int v : topology.set("rigid"))
      if (fitted[v]) vertices.push_back(v);
  if (vertices.size() < 50) {
    vertices.clear();
    for (int v = 0; v < topology.vertex_count(); ++v)
      if (fitted[v]) vertices.push_back(v);
  }
  return vertices;
}

ScanLandmarks moved(const Similarity& motion, ScanLandmarks landmarks) {
  for (ScanLandmark& landmark : landmarks) landmark.position = motion * landmark.position;
  return landmarks;
}

}  // namespace

struct Registration::Impl {
  Template head;
  RegisterOptions options;
  LoopSubdivision loop;
  Points refined_neutral;
  std::vector<bool> fitted, fitted_control;

  mutable std::once_flag finder_once, sighting_once;
  mutable std::shared_ptr<const FaceFinder> finder;
  mutable std::optional<DetectedLandmarks> sighting;  // of the template's own shape

  Impl(Template given, RegisterOptions given_options)
      : head(std::move(given)), options(std::move(given_options)), loop(head.topology, head.subdivisions) {
    options.validate();
    refined_neutral = loop(head.neutral);
    fitted = exposed_vertices(*loop.refined(), refined_neutral);
    fitted_control.assign(fitted.begin(), fitted.begin() + head.topology->vertex_count());
  }

  const FaceFinder& face_finder() const {
    std::call_once(finder_once,
                   [&] { finder = options.finder ? options.finder : std::make_shared<const FaceFinder>(); });
    return *finder;
  }
  const ScanLandmarks* template_sighting() const;
  Prepared prepare(const Mesh& scan, const std::optional<ScanLandmarks>& given) const;
  Anchors anchors_for(const Prepared& prepared) const;
  Points detail(const Points& positions) const;
  Points zhu(const Anchors& anchors, const Similarity& scan_from_template, const ScanSurface& scan) const;
  Registered finish(const Prepared& prepared, const ScanSurface& scan, const Anchors& anchors, const Points& positions,
                    const Points& reference, const Similarity& face_from_mm) const;
};

// What the finder makes of the template's bare shape; null when it sees no face there.
const ScanLandmarks* Registration::Impl::template_sighting() const {
  std::call_once(sighting_once, [&] {
    try {
      Mesh shape;
      shape.topology = loop.refined();
      shape.positions = refined_neutral;
      sighting = detect_landmarks(shape, face_finder());
    } catch (const InputError&) {
    }
  });
  return sighting ? &sighting->points : nullptr;
}

Prepared Registration::Impl::prepare(const Mesh& scan, const std::optional<ScanLandmarks>& given) const {
  Prepared prepared{scan, 1.0, {}, false, false, {}};
  if (given && given->size() >= enough_given) {
    prepared.landmarks = *given;
    // Landmarks found earlier keep their confidence below one and the finder's bias.
    prepared.automatic = std::none_of(given->begin(), given->end(), [](const auto& l) { return l.confidence >= 1.0; });
    prepared.decisions.push_back(std::to_string(given->size()) + " landmarks given");
    return prepared;
  }
  if (!head.ibug68)
    throw InputError("the template names no 68-point landmarks, so none can be found on the scan; give at least " +
                     std::to_string(enough_given) + " of its own landmarks by file");
  const DetectedLandmarks found = detect_landmarks(scan, face_finder());
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

Anchors Registration::Impl::anchors_for(const Prepared& prepared) const {
  const ScanLandmarks* seen = prepared.automatic && !prepared.coloured ? template_sighting() : nullptr;
  Anchors anchors = make_anchors(head, head.neutral, prepared.landmarks, seen, options.least_confidence);
  if (anchors.size() < 6)
    throw InputError("only " + std::to_string(anchors.size()) +
                     " landmarks of the scan can be trusted, 6 are needed; place some by hand (landmarks/<pose>.json)");
  return anchors;
}

// Eyes, nose and lips, where nodes stand closer.
Points Registration::Impl::detail(const Points& positions) const {
  std::vector<int> rows;
  if (head.ibug68)
    for (int i = 27; i < 68; ++i)
      if ((*head.ibug68)[i] >= 0) rows.push_back((*head.ibug68)[i]);
  return positions(rows, Eigen::all);
}

Points Registration::Impl::zhu(const Anchors& anchors, const Similarity& scan_from_template,
                               const ScanSurface& scan) const {
  const Points start = loop(warp(head.neutral, fitted_control, anchors, scan_from_template, scan)(head.neutral));
  const HeadAxis axis = head_axis(head.neutral, fitted_control, scan_from_template);
  ProjectOptions projection;
  projection.max_displacement = options.displacement_limit;
  Points positions =
      project_cylindrically(*loop.refined(), start, fitted, scan, axis.point, axis.direction, projection).positions;
  carry_components(*loop.refined(), start, fitted, true, positions);
  return positions;
}

Registered Registration::Impl::finish(const Prepared& prepared, const ScanSurface& scan, const Anchors& anchors,
                                      const Points& positions, const Points& reference,
                                      const Similarity& face_from_mm) const {
  Registered result;
  result.mesh.topology = loop.refined();
  result.mesh.positions = transformed(face_from_mm, positions);
  Similarity mm_from_scan;
  mm_from_scan.scale = prepared.scale;
  result.face_from_scan = face_from_mm * mm_from_scan;
  std::vector<LandmarkResidual> residuals;
  for (int i = 0; i < anchors.size(); ++i) {
    const Eigen::Vector3d on_mesh = positions.row(anchors.vertices[i]), on_scan = anchors.targets.row(i);
    const double distance = (on_mesh - on_scan).norm();
    residuals.push_back({anchors.names[i], distance, anchors.confidence[i]});
    result.landmarks.push_back(
        {anchors.names[i], face_from_mm * on_scan, face_from_mm * on_mesh, anchors.confidence[i], distance});
  }
  result.detected = moved(face_from_mm, prepared.landmarks);
  result.coloured = prepared.coloured;
  result.decisions = prepared.decisions;
  result.quality = judge(head, *loop.refined(), fitted, reference, positions, scan, residuals, options.limits);
  return result;
}

Registration::Registration(Template head, RegisterOptions options)
    : impl_(std::make_unique<Impl>(std::move(head), std::move(options))) {}
Registration::~Registration() = default;

const Template& Registration::head() const { return impl_->head; }
const std::shared_ptr<const Topology>& Registration::refined() const { return impl_->loop.refined(); }
const Points& Registration::refined_neutral() const { return impl_->refined_neutral; }

Registered Registration::neutral(const Mesh& clean_scan, const std::optional<ScanLandmarks>& landmarks,
                                 Progress& progress) const {
  const Impl& my = *impl_;
  Prepared prepared = my.prepare(clean_scan, landmarks);
  progress.check();
  const ScanSurface scan(prepared.scan);
  const Anchors anchors = my.anchors_for(prepared);
  const Points sources = my.head.neutral(anchors.vertices, Eigen::all);
  const Alignment alignment = align_landmarks(sources, anchors.targets, anchors.confidence, Scaling::free);
  prepared.decisions.push_back("template scaled by " + number(alignment.scan_from_template.scale) +
                               ", landmarks then lie " + number(alignment.rms) + " mm off");
  Points positions;
  if (my.options.method == Method::zhu) {
    positions = my.zhu(anchors, alignment.scan_from_template, scan);
  } else {
    const RbfMap map = warp(my.head.neutral, my.fitted_control, anchors, alignment.scan_from_template, scan);
    const Points start = my.loop(map(my.head.neutral));
    const Points rest = transformed(alignment.scan_from_template, my.refined_neutral);
    positions = fit_nonrigid(*my.loop.refined(), rest, start, my.fitted, scan, landmark_terms(anchors), my.detail(rest),
                             {}, progress)
                    .positions;
  }
  const auto pose = face_axes(my.head, positions), model = face_axes(my.head, my.head.neutral);
  const Similarity face_from_mm =
      pose && model ? normalize_orientation(*pose, *model)
                    : fit_similarity_robust(positions, my.refined_neutral, Scaling::fixed, 1.0).target_from_source;
  return my.finish(prepared, scan, anchors, positions, my.refined_neutral, face_from_mm);
}

namespace {

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

Registered Registration::expression(const Registered& neutral, const Mesh& clean_scan,
                                    const std::optional<ScanLandmarks>& landmarks, Progress& progress) const {
  const Impl& my = *impl_;
  if (neutral.mesh.positions.rows() != my.loop.refined()->vertex_count())
    throw InputError("the registered neutral has another topology than the template");
  Prepared prepared = my.prepare(clean_scan, landmarks);
  progress.check();
  const ScanSurface scan(prepared.scan);
  const std::vector<int> rigid = rigid_vertices(*my.loop.refined(), my.fitted);
  if (my.options.method == Method::zhu) {
    const Anchors anchors = my.anchors_for(prepared);
    const Alignment alignment = align_landmarks(my.head.neutral(anchors.vertices, Eigen::all), anchors.targets,
                                                anchors.confidence, Scaling::free);
    const Points positions = my.zhu(anchors, alignment.scan_from_template, scan);
    const auto pose = face_axes(my.head, positions), model = face_axes(my.head, neutral.mesh.positions);
    const Similarity face_from_mm =
        pose && model
            ? normalize_orientation(*pose, *model)
            : fit_similarity_robust(positions, neutral.mesh.positions, Scaling::fixed, 1.0).target_from_source;
    return my.finish(prepared, scan, anchors, positions, neutral.mesh.positions, face_from_mm);
  }
  const Anchors found = expression_anchors(my.head, neutral, prepared, my.options.least_confidence);
  if (found.size() < 6) throw InputError("fewer than 6 landmarks of the scan can be trusted; place some by hand");
  const Similarity scan_from_face = head_motion(neutral, found, rigid, scan);
  const Points rest = transformed(scan_from_face, neutral.mesh.positions);
  const Anchors anchors = plausible_anchors(found, rest);
  if (anchors.size() < found.size())
    prepared.decisions.push_back(std::to_string(found.size() - anchors.size()) +
                                 " landmarks left out: farther from the neutral than skin can move");
  const JawOpening jaw = find_jaw_opening(my.head, *my.loop.refined(), rest, my.fitted, anchors, scan);
  if (jaw.angle > 0.0)
    prepared.decisions.push_back("jaw open by " + number(jaw.angle * 180.0 / M_PI, "%.0f") + " degrees");
  std::vector<PointTerm> pulls = landmark_terms(anchors);
  pulls.insert(pulls.end(), jaw.terms.begin(), jaw.terms.end());
  NonrigidOptions nonrigid;
  nonrigid.free_scale = false;
  // The same person: landmarks hardly lie, and the shape they give is kept against sliding along the surface.
  nonrigid.first_stiffness = 1.0;
  nonrigid.last_stiffness = 0.1;
  nonrigid.first_landmarks = 5.0;
  nonrigid.last_landmarks = 0.5;
  nonrigid.landmark_steps = 6;
  const Points positions =
      fit_nonrigid(*my.loop.refined(), rest, rest, my.fitted, scan, pulls, my.detail(rest), nonrigid, progress)
          .positions;
  const Similarity face_from_mm = fit_similarity_robust(positions(rigid, Eigen::all),
                                                        neutral.mesh.positions(rigid, Eigen::all), Scaling::fixed, 0.2)
                                      .target_from_source;
  return my.finish(prepared, scan, anchors, positions, neutral.mesh.positions, face_from_mm);
}

Method method_named(const std::string& name) {
  if (name == "default") return Method::standard;
  if (name == "zhu") return Method::zhu;
  throw UsageError("unknown registration method \"" + name + "\"; did you mean \"" +
                   nearest_name(name, {"default", "zhu"}) + "\"?");
}

std::string name_of(Method method) { return method == Method::zhu ? "zhu" : "default"; }

void RegisterOptions::validate() const {
  if (!(displacement_limit > 0.0)) throw InputError("registration: the displacement limit must be positive");
  if (!(least_confidence >= 0.0 && least_confidence <= 1.0))
    throw InputError("registration: the least confidence must lie between 0 and 1");
}

Registered register_neutral(const Template& head, const Mesh& clean_scan, const std::optional<ScanLandmarks>& landmarks,
                            const RegisterOptions& options, Progress& progress) {
  return Registration(head, options).neutral(clean_scan, landmarks, progress);
}

Registered register_expression(const Template& head, const Registered& neutral, const Mesh& clean_scan,
                               const std::optional<ScanLandmarks>& landmarks, const RegisterOptions& options,
                               Progress& progress) {
  return Registration(head, options).expression(neutral, clean_scan, landmarks, progress);
}

}  // namespace vultus::registration
