#include "render/portrait.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"

namespace vultus::render {

void PortraitOptions::validate() const {
  if (width < 1 || height < 1 || width > 16384 || height > 16384)
    throw UsageError("picture size must be 1x1 to 16384x16384 pixels");
  if (!(margin > 0.0) || !std::isfinite(margin)) throw UsageError("portrait margin must be above 0");
  if (!std::isfinite(azimuth) || !(std::abs(elevation) <= 0.5 * std::numbers::pi))
    throw UsageError("portrait elevation must lie between straight down and straight up");
}

namespace {

Box framed_bounds(const Topology& topology, const Points& positions) {
  for (const char* name : {"face_narrow", "face"}) {
    if (!topology.has_set(name) || topology.set(name).empty()) continue;
    const std::vector<int>& face = topology.set(name);
    Points framed(static_cast<Eigen::Index>(face.size()), 3);
    for (std::size_t i = 0; i < face.size(); ++i) framed.row(static_cast<Eigen::Index>(i)) = positions.row(face[i]);
    return bounds(framed);
  }
  return bounds(positions);
}

}  // namespace

Camera portrait_camera(const Topology& topology, const Points& positions, const PortraitOptions& options) {
  options.validate();
  if (positions.rows() == 0) throw InputError("portrait: the mesh has no vertices");
  const Box box = framed_bounds(topology, positions);
  const Eigen::Vector3d size = box.max - box.min;
  const double aspect = static_cast<double>(options.width) / options.height;
  const double across = std::hypot(size.x() * std::cos(options.azimuth), size.z() * std::sin(options.azimuth));
  const double view_height = options.margin * std::max({size.y(), across / aspect, 1e-6});
  const double field_of_view = 16.0 * std::numbers::pi / 180.0;
  // The distance is taken to the front of the face: that is what fills the frame.
  const double distance = 0.5 * view_height / std::tan(0.5 * field_of_view) + 0.5 * size.z();
  const Eigen::Vector3d towards(std::sin(options.azimuth) * std::cos(options.elevation), std::sin(options.elevation),
                                std::cos(options.azimuth) * std::cos(options.elevation));
  return Camera::look_at(box.centre() + distance * towards, box.centre(), {0, 1, 0}, field_of_view, options.width,
                         options.height);
}

}  // namespace vultus::render
