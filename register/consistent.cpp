#include "register/consistent.h"

#include <utility>

#include "core/error.h"
#include "register/found_landmarks.h"
#include "register/method.h"
#include "register/sanchez.h"
#include "register/scan_facts.h"
#include "register/standard.h"
#include "register/zhu.h"

namespace vultus::registration {
namespace {

ScanLandmarks moved(const Similarity& motion, ScanLandmarks landmarks) {
  for (ScanLandmark& landmark : landmarks) landmark.position = motion * landmark.position;
  return landmarks;
}

Fit fit_neutral(const FitInput& input, Progress& progress) {
  switch (input.options.method) {
    case Method::zhu:
      return fit_zhu(input, input.model.neutral);
    case Method::sanchez:
      return fit_sanchez_neutral(input, progress);
    case Method::standard:
      break;
  }
  return fit_standard_neutral(input, progress);
}

Fit fit_expression(const FitInput& input, const Registered& neutral, Progress& progress) {
  switch (input.options.method) {
    case Method::zhu:
      return fit_zhu(input, neutral.mesh.positions);
    case Method::sanchez:
      return fit_sanchez_expression(input, neutral, progress);
    case Method::standard:
      break;
  }
  return fit_standard_expression(input, neutral, progress);
}

// A scan as it comes from outside.
struct GivenScan {
  const Mesh& mesh;
  std::vector<bool> invented;  // per triangle, or empty
  ScanFacts facts;
};

// A template without any names is looked at by the finder, which scans will need too.
Template with_names(Template head, RegisterOptions& options) {
  options.validate();
  if (head.ibug68 || !head.landmarks.empty()) return head;
  if (!options.finder) options.finder = std::make_shared<const FaceFinder>();
  return with_found_landmarks(std::move(head), *options.finder);
}

}  // namespace

struct Registration::Impl {
  RegisterOptions options;
  RefinedTemplate model;
  Preparation preparation;

  Impl(Template given, RegisterOptions given_options)
      : options(std::move(given_options)),
        model(with_names(std::move(given), options)),
        preparation(model, options) {}

  Registered neutral(const GivenScan& given, const std::optional<ScanLandmarks>& landmarks, Progress& progress) const;
  Registered expression(const Registered& neutral, const GivenScan& given,
                        const std::optional<ScanLandmarks>& landmarks, Progress& progress) const;
  Registered finish(const FitInput& input, Fit fit, const Points& reference, ScanFacts facts) const;
};

// The fit told in the face frame, with what a person needs to trust it.
Registered Registration::Impl::finish(const FitInput& input, Fit fit, const Points& reference, ScanFacts facts) const {
  Registered result;
  result.mesh.topology = model.loop.refined();
  result.mesh.positions = transformed(fit.face_from_scan, fit.positions);
  Similarity mm_from_scan;
  mm_from_scan.scale = input.prepared.scale;
  result.face_from_scan = fit.face_from_scan * mm_from_scan;
  std::vector<LandmarkResidual> residuals;
  const Anchors& anchors = fit.anchors;
  for (int i = 0; i < anchors.size(); ++i) {
    const Eigen::Vector3d on_mesh = fit.positions.row(anchors.vertices[i]), on_scan = anchors.targets.row(i);
    const double distance = (on_mesh - on_scan).norm();
    residuals.push_back({anchors.names[i], distance, anchors.confidence[i]});
    result.landmarks.push_back({anchors.names[i], fit.face_from_scan * on_scan, fit.face_from_scan * on_mesh,
                                anchors.confidence[i], distance});
  }
  result.detected = moved(fit.face_from_scan, input.prepared.landmarks);
  result.coloured = input.prepared.coloured;
  result.decisions = input.prepared.decisions;
  result.decisions.insert(result.decisions.end(), fit.decisions.begin(), fit.decisions.end());
  result.look = fit.look;
  if (fit.look) result.on_look = fit.positions;
  add_facts(input, fit, facts);
  result.quality = judge(model.head, model.topology(), model.fitted, reference, fit.positions, input.scan, residuals,
                         options.limits, facts);
  return result;
}

Registration::Registration(Template head, RegisterOptions options)
    : impl_(std::make_unique<Impl>(std::move(head), std::move(options))) {}
Registration::~Registration() = default;

const Template& Registration::head() const { return impl_->model.head; }
const std::shared_ptr<const Topology>& Registration::refined() const { return impl_->model.loop.refined(); }
const Points& Registration::refined_neutral() const { return impl_->model.neutral; }

Registered Registration::Impl::neutral(const GivenScan& given, const std::optional<ScanLandmarks>& landmarks,
                                       Progress& progress) const {
  const Prepared prepared = preparation(given.mesh, landmarks);
  progress.check();
  const ScanSurface scan(prepared.scan, given.invented);
  const FitInput input{model, preparation, prepared, scan, options};
  return finish(input, fit_neutral(input, progress), model.neutral, given.facts);
}

Registered Registration::Impl::expression(const Registered& neutral, const GivenScan& given,
                                          const std::optional<ScanLandmarks>& landmarks, Progress& progress) const {
  if (neutral.mesh.positions.rows() != model.topology().vertex_count())
    throw InputError("the registered neutral has another topology than the template");
  const Prepared prepared = preparation(given.mesh, landmarks, &neutral.mesh.positions);
  progress.check();
  const ScanSurface scan(prepared.scan, given.invented);
  const FitInput input{model, preparation, prepared, scan, options};
  return finish(input, fit_expression(input, neutral, progress), neutral.mesh.positions, given.facts);
}

Registered Registration::neutral(const Mesh& clean_scan, const std::optional<ScanLandmarks>& landmarks,
                                 Progress& progress) const {
  return impl_->neutral({clean_scan, {}, {}}, landmarks, progress);
}

Registered Registration::neutral(const scan::CleanScan& scan, const std::optional<ScanLandmarks>& landmarks,
                                 Progress& progress) const {
  return impl_->neutral({scan.mesh, scan.invented, facts_of(scan.report)}, landmarks, progress);
}

Registered Registration::expression(const Registered& neutral, const Mesh& clean_scan,
                                    const std::optional<ScanLandmarks>& landmarks, Progress& progress) const {
  return impl_->expression(neutral, {clean_scan, {}, {}}, landmarks, progress);
}

Registered Registration::expression(const Registered& neutral, const scan::CleanScan& scan,
                                    const std::optional<ScanLandmarks>& landmarks, Progress& progress) const {
  return impl_->expression(neutral, {scan.mesh, scan.invented, facts_of(scan.report)}, landmarks, progress);
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
