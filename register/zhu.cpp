#include "register/zhu.h"

#include "register/align.h"
#include "register/fill.h"
#include "register/project.h"
#include "register/start_warp.h"

namespace vultus::registration {

Fit fit_zhu(const FitInput& input, const Points& reference) {
  const RefinedTemplate& model = input.model;
  const Template& head = model.head;
  Fit fit;
  fit.anchors = template_anchors(input);
  const Similarity scan_from_template = align_landmarks(head.neutral(fit.anchors.vertices, Eigen::all),
                                                        fit.anchors.targets, fit.anchors.confidence, Scaling::free)
                                            .scan_from_template;
  const RbfMap map = start_warp(head.neutral, model.fitted_control, fit.anchors, scan_from_template, input.scan);
  const Points start = model.loop(map(head.neutral));
  const HeadAxis axis = head_axis(head.neutral, model.fitted_control, scan_from_template);
  ProjectOptions projection;
  projection.max_displacement = input.options.displacement_limit;
  fit.positions =
      project_cylindrically(model.topology(), start, model.fitted, input.scan, axis.point, axis.direction, projection)
          .positions;
  carry_components(model.topology(), start, model.fitted, true, fit.positions);
  fit.face_from_scan = upright(head, fit.positions, reference);
  return fit;
}

}  // namespace vultus::registration
