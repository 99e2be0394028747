#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "apps/virtual_stage/muscles.h"
#include "apps/virtual_stage/smooth_field.h"
#include "core/mesh.h"
#include "register/template.h"

namespace vultus::virtual_stage {

/// The control topology with the lines along which lips and lids meet added as vertex sets, so that subdivision
/// carries them along: "lip_line_{upper,lower}", "lid_line_{upper,lower}_{left,right}" (lids with both eye corners).
std::shared_ptr<const Topology> with_contact_lines(const registration::Template& head);

/// One identity's neutral on the subdivided template, with its landmarks on either side.
struct FaceFeatures {
  const Topology& topology;  ///< subdivided `with_contact_lines`
  const Points& positions;   ///< neutral, mm
  std::vector<int> mirror;   ///< twin of each control vertex
  Points normals;
  SmoothFields fields;  ///< on the neutral
  double scale = 1.0;   ///< distance of the outer eye corners / 90 mm

  FaceFeatures(const Topology& topology, const Points& positions);

  /// A landmark named for the left or the middle, or its twin on the right.
  Eigen::Vector3d at(const std::string& left_name, Side side = Side::left) const;
  std::vector<bool> members(const std::string& set) const;
  /// A set's vertices from right to left.
  std::vector<int> line(const std::string& set) const;
};

/// Averages values (vertex_count) with those of their neighbours, `rounds` times, so that a set's border is no step.
void soften(Eigen::VectorXd& values, const Topology& topology, int rounds);

/// 0 below `low`, 1 above `high`, smooth between.
double smooth_step(double low, double high, double x);

/// Piecewise linear y(x) through points with rising x; constant outside.
double interpolate(const std::vector<std::pair<double, double>>& points, double x);

}  // namespace vultus::virtual_stage
