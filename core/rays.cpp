#include "core/rays.h"

#include <embree3/rtcore.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/flush_denormals.h"

namespace vultus {
namespace {

/// Barycentric coordinates of the point of triangle abc nearest to p (Ericson 2005, §5.1.5).
Eigen::Vector3d closest_barycentric(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                    const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const Eigen::Vector3d bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double v = d1 / (d1 - d3);
    return {1 - v, v, 0};
  }
  const Eigen::Vector3d cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double w = d2 / (d2 - d6);
    return {1 - w, 0, w};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  const double scale = 1.0 / (va + vb + vc);
  const double v = vb * scale, w = vc * scale;
  return {1 - v - w, v, w};
}

}  // namespace

struct RayScene::Impl {
  Points corners;  // vertices, mm
  Triangles triangles;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // Embree works in float about this point
  double extent = 0.0;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  Impl(const Topology& topology, const Points& positions) : corners(positions), triangles(topology.triangles()) {
    if (positions.rows() != topology.vertex_count())
      throw InputError("rays: " + std::to_string(positions.rows()) + " positions for " +
                       std::to_string(topology.vertex_count()) + " vertices");
    if (!positions.allFinite()) throw InputError("rays: the mesh has vertices that are not finite");
    if (positions.rows() > 0) {
      const Box box = bounds(positions);
      centre = box.centre();
      extent = box.diagonal();
    }
    const FlushDenormals guard;
    device = rtcNewDevice(nullptr);
    if (!device) throw ToolError("Embree could not start on this processor (it needs SSE2)");
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    if (triangles.rows() > 0) add_triangles();
    rtcCommitScene(scene);
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE) {
      release();
      throw Error("Embree could not build its hierarchy: not enough memory");
    }
  }
  ~Impl() { release(); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void release() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }

  void add_triangles() {
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), corners.rows()));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   3 * sizeof(unsigned), triangles.rows()));
    if (vertices && indices) {
      for (Eigen::Index v = 0; v < corners.rows(); ++v)
        for (int k = 0; k < 3; ++k) vertices[3 * v + k] = static_cast<float>(corners(v, k) - centre[k]);
      for (Eigen::Index t = 0; t < triangles.rows(); ++t)
        for (int k = 0; k < 3; ++k) indices[3 * t + k] = static_cast<unsigned>(triangles(t, k));
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(scene, geometry);
    }
    rtcReleaseGeometry(geometry);
  }

  Eigen::Vector3d corner(int triangle, int k) const { return corners.row(triangles(triangle, k)).transpose(); }

  RTCRay ray(const Eigen::Vector3d& origin, const Eigen::Vector3d& unit, double min_distance,
             double max_distance) const {
    const Eigen::Vector3f start = (origin - centre).cast<float>();
    const Eigen::Vector3f along = unit.cast<float>();
    RTCRay r{};
    r.org_x = start.x();
    r.org_y = start.y();
    r.org_z = start.z();
    r.dir_x = along.x();
    r.dir_y = along.y();
    r.dir_z = along.z();
    r.tnear = static_cast<float>(min_distance);
    r.tfar = static_cast<float>(max_distance);
    r.mask = ~0u;
    return r;
  }

  /// The hit Embree found in float, solved again in double on that triangle.
  RayHit refined(const RTCRayHit& found, const Eigen::Vector3d& origin, const Eigen::Vector3d& unit) const {
    const int t = static_cast<int>(found.hit.primID);
    Eigen::Vector3d barycentric(1.0 - found.hit.u - found.hit.v, found.hit.u, found.hit.v);
    double distance = found.ray.tfar;
    const Eigen::Vector3d a = corner(t, 0), ab = corner(t, 1) - a, ac = corner(t, 2) - a;
    const Eigen::Vector3d p = unit.cross(ac);
    const double determinant = ab.dot(p);
    if (std::abs(determinant) > 1e-10 * ab.norm() * ac.norm()) {
      const Eigen::Vector3d s = (origin - a) / determinant;
      const Eigen::Vector3d q = s.cross(ab);
      const double u = std::clamp(s.dot(p), 0.0, 1.0), v = std::clamp(unit.dot(q), 0.0, 1.0 - u);
      barycentric = {1.0 - u - v, u, v};
      distance = ac.dot(q);
    }
    return {{t, barycentric}, distance};
  }

  struct ClosestSearch {
    const Impl* mesh;
    Eigen::Vector3d point;
    double slack;  // mm by which float geometry may differ from ours
    ClosestPoint best;
  };
};

RayScene::RayScene(const Topology& topology, const Points& positions)
    : impl_(std::make_unique<Impl>(topology, positions)) {}
RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

std::optional<RayHit> RayScene::hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                    double min_distance, double max_distance) const {
  const FlushDenormals guard;
  const Eigen::Vector3d unit = direction.normalized();
  RTCRayHit query{};
  query.ray = impl_->ray(origin, unit, min_distance, max_distance);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(impl_->scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return impl_->refined(query, origin, unit);
}

bool RayScene::occluded(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double min_distance,
                        double max_distance) const {
  const FlushDenormals guard;
  RTCRay query = impl_->ray(origin, direction.normalized(), min_distance, max_distance);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(impl_->scene, &context, &query);
  return query.tfar < 0.0f;  // Embree marks an occluded ray with -inf
}

std::optional<ClosestPoint> RayScene::closest(const Eigen::Vector3d& point, double max_distance) const {
  if (impl_->triangles.rows() == 0) return std::nullopt;
  const FlushDenormals guard;
  // Embree only chooses the candidates; distances are in double. The search radius keeps a margin for float rounding,
  // so that equally near triangles are all seen and the lowest index wins whatever the order.
  const Eigen::Vector3d local = point - impl_->centre;
  Impl::ClosestSearch search{impl_.get(), point, 4e-7 * (impl_->extent + local.norm()), {}};
  search.best.distance = max_distance;
  RTCPointQuery query{};
  query.x = static_cast<float>(local.x());
  query.y = static_cast<float>(local.y());
  query.z = static_cast<float>(local.z());
  query.radius = max_distance < 1e15 ? static_cast<float>(max_distance * (1 + 1e-6) + search.slack)
                                     : std::numeric_limits<float>::infinity();
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  const auto visit = [](RTCPointQueryFunctionArguments* args) {
    auto& s = *static_cast<Impl::ClosestSearch*>(args->userPtr);
    const int t = static_cast<int>(args->primID);
    const Eigen::Vector3d a = s.mesh->corner(t, 0), b = s.mesh->corner(t, 1), c = s.mesh->corner(t, 2);
    const Eigen::Vector3d barycentric = closest_barycentric(s.point, a, b, c);
    const Eigen::Vector3d position = barycentric[0] * a + barycentric[1] * b + barycentric[2] * c;
    const double distance = (position - s.point).norm();
    const bool nearer = distance < s.best.distance ||
                        (distance == s.best.distance && (!s.best.place.valid() || t < s.best.place.triangle));
    if (!nearer) return false;
    s.best = {{t, barycentric}, position, distance};
    args->query->radius = static_cast<float>(distance * (1 + 1e-6) + s.slack);
    return true;
  };
  rtcPointQuery(impl_->scene, &query, &context, visit, &search);
  if (!search.best.place.valid()) return std::nullopt;
  return search.best;
}

}  // namespace vultus
