#include "register/consistent.h"

#include <utility>

#include "core/error.h"
#include "register/method.h"
#include "register/sanchez.h"
#include "register/standard.h"
#include "register/zhu.h"

namespace vultus::registration {
namespace {

ScanLandmarks moved(const Similarity& motion, ScanLandmarks landmarks) {
  for (ScanLandmark& landmark : landmarks) landmark.position = motion * landmark.position;
  return landmarks;
}

Mesh shape_of(const RefinedTemplate& model) {
  Mesh shape;
  shape.topology = model.loop.refined();
  shape.positions = model.neutral;
  return shape;
}

Fit fit_neutral(const FitInput& input, Progress& progress) {
  switch (input.options.method) {
    case Method::zhu: return fit_zhu(input, input.model.neutral);
    case Method::sanchez: return fit_sanchez_neutral(input, progress);
    case Method::standard: break;
  }
  return fit_standard_neutral(input, progress);
}

Fit fit_expression(const FitInput& input, const Registered& neutral, Progress& progress) {
  switch (input.options.method) {
    case Method::zhu: return fit_zhu(input, neutral.mesh.positions);
    case Method::sanchez: return fit_sanchez_expression(input, neutral, progress);
    case Method::standard: break;
  }
  return fit_standard_expression(input, neutral, progress);
}

}  // namespace

struct Registration::Impl {
  RegisterOptions options;
  RefinedTemplate model;
  Preparation preparation;

  Impl(Template given, RegisterOptions given_options)
      : options(std::move(given_options)),
        model((options.validate(), std::move(given))),
        preparation(model.head, shape_of(model), options.finder) {}

  Registered finish(const FitInput& input, Fit fit, const Points& reference) const;
};

// The fit told in the face frame, with what a person needs to trust it.
Registered Registration::Impl::finish(const FitInput& input, Fit fit, const Points& reference) const {
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
  result.quality = judge(model.head, model.topology(), model.fitted, reference, fit.positions, input.scan, residuals,
                         options.limits);
  return result;
}

Registration::Registration(Template head, RegisterOptions options)
    : impl_(std::make_unique<Impl>(std::move(head), std::move(options))) {}
Registration::~Registration() = default;

const Template& Registration::head() const { return impl_->model.head; }
const std::shared_ptr<const Topology>& Registration::refined() const { return impl_->model.loop.refined(); }
const Points& Registration::refined_neutral() const { return impl_->model.neutral; }

Registered Registration::neutral(const Mesh& clean_scan, const std::optional<ScanLandmarks>& landmarks,
                                 Progress& progress) const {
  const Impl& my = *impl_;
  const Prepared prepared = my.preparation(clean_scan, landmarks);
  progress.check();
  const ScanSurface scan(prepared.scan);
  const FitInput input{my.model, my.preparation, prepared, scan, my.options};
  return my.finish(input, fit_neutral(input, progress), my.model.neutral);
}

Registered Registration::expression(const Registered& neutral, const Mesh& clean_scan,
                                    const std::optional<ScanLandmarks>& landmarks, Progress& progress) const {
  const Impl& my = *impl_;
  if (neutral.mesh.positions.rows() != my.model.topology().vertex_count())
    throw InputError("the registered neutral has another topology than the template");
  const Prepared prepared = my.preparation(clean_scan, landmarks);
  progress.check();
  const ScanSurface scan(prepared.scan);
  const FitInput input{my.model, my.preparation, prepared, scan, my.options};
  return my.finish(input, fit_expression(input, neutral, progress), neutral.mesh.positions);
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
