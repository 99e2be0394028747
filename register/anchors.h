#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/transform.h"
#include "register/detect_landmarks.h"
#include "register/landmarks.h"

namespace vultus::registration {

/// Template vertices and where on the scan they should come to lie; rows correspond.
struct Anchors {
  std::vector<std::string> names;
  std::vector<int> vertices;   ///< control mesh, kept by subdivision
  Points targets;              ///< scan frame
  Eigen::VectorXd confidence;  ///< [0, 1]
  int size() const { return static_cast<int>(vertices.size()); }
  Anchors at(const std::vector<int>& rows) const;  ///< these alone
  void add(const std::string& name, int vertex, const Eigen::Vector3d& target, double sureness);
};

/// The scan's unit as the eyes tell it: factor on the scan's coordinates that makes the outer eye corners' distance one
/// a head can have (65–125 mm), 1 where it is already or where no usual unit helps.
double unit_correction(double outer_eye_distance);

/// What a finder says of a grey shape is biased (brows, lids) but alike on every face: where the template was seen
/// under the same conditions (`seen_template`, template frame), each target that was seen in
/// pictures is the template vertex moved as its sighting moved. Else targets are the landmarks themselves. Landmarks
/// below `least_confidence`, contour points (the chin's too, unless `chin`) and names that the template lacks are left
/// out.
Anchors make_anchors(const Template& head, const Points& vertices, const ScanLandmarks& scan,
                     const ScanLandmarks* seen_template, double least_confidence, bool chin = false);

/// Leaves out found landmarks (confidence below 1) that lie farther from `rest`, the neutral moved rigidly into the
/// scan, than skin can go there, and with a corner of an eye that whole eye, with the middle of the upper lip the
/// mouth.
Anchors plausible_anchors(const Anchors& anchors, const Points& rest);

/// `found` with every point that `given` names replaced by the given one.
ScanLandmarks overridden(ScanLandmarks found, const ScanLandmarks& given);

}  // namespace vultus::registration
