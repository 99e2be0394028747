#pragma once

#include <optional>
#include <vector>

#include "core/mesh.h"
#include "core/rays.h"

namespace vultus::registration {

/// A place of the scan that a template vertex may be drawn to.
struct Correspondence {
  Eigen::Vector3d position;  ///< scan frame, mm
  Eigen::Vector3d normal;    ///< unit, of the scan there
  double distance = 0.0;     ///< mm from the query
};

/// A cleaned scan as a target of registration: nearest places and ray hits that face the right way and are no edge of
/// the data. Queries are const and may run from many threads.
class ScanSurface {
 public:
  /// `scan` must outlive this object; `invented` (per triangle, may be empty) marks places that are no data.
  explicit ScanSurface(const Mesh& scan, std::vector<bool> invented = {});

  const Mesh& mesh() const { return *scan_; }
  const RayScene& rays() const { return rays_; }

  /// Nearest place within `limit` mm; nothing where it lies on the border of the data, in invented triangles, or where
  /// the scan's normal makes a cosine below `least_cosine` with `normal`.
  std::optional<Correspondence> nearest(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double limit,
                                        double least_cosine) const;
  /// The place on the line through `point` along the unit `direction`, at most `limit` mm to either side, that is
  /// nearest to `point` and whose normal makes a cosine of at least `least_cosine` with `normal`.
  std::optional<Correspondence> along(const Eigen::Vector3d& point, const Eigen::Vector3d& direction,
                                      const Eigen::Vector3d& normal, double limit, double least_cosine) const;

  bool on_border(const SurfacePoint& place) const;
  bool is_data(const SurfacePoint& place) const { return invented_.empty() || !invented_[place.triangle]; }
  Eigen::Vector3d normal_at(const SurfacePoint& place) const;
  Eigen::RowVector3d vertex_normal(int vertex) const { return normals_.row(vertex); }  ///< unit, of the scan
  /// True for a vertex that belongs to invented triangles only.
  bool is_invented(int vertex) const { return !invented_vertex_.empty() && invented_vertex_[vertex]; }

 private:
  const Mesh* scan_;
  RayScene rays_;
  Points normals_;              // per vertex, smoothed over the scanner's noise
  std::vector<bool> border_;    // per vertex
  std::vector<bool> invented_;  // per triangle, or empty
  std::vector<bool> invented_vertex_;
};

}  // namespace vultus::registration
