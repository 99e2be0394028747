#include "render/traced_scene.h"

#include <embree3/rtcore.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "core/error.h"
#include "core/flush_denormals.h"

namespace vultus::render {
namespace {

using Eigen::Vector3f;

/// A texture in the reflectance range, held as packed RGB.
class AlbedoMap {
 public:
  explicit AlbedoMap(const Image& image) : width_(image.width()), height_(image.height()) {
    texels_.reserve(static_cast<std::size_t>(width_) * height_);
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) texels_.push_back(image.rgb_at(x, y).cwiseMax(0.0f).cwiseMin(1.0f));
  }
  Vector3f at(const Eigen::Vector2f& uv) const {
    const float x = std::clamp(uv.x() * static_cast<float>(width_) - 0.5f, 0.0f, static_cast<float>(width_ - 1));
    const float y =
        std::clamp((1.0f - uv.y()) * static_cast<float>(height_) - 0.5f, 0.0f, static_cast<float>(height_ - 1));
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const int x1 = std::min(x0 + 1, width_ - 1), y1 = std::min(y0 + 1, height_ - 1);
    const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
    return (texel(x0, y0) * (1 - fx) + texel(x1, y0) * fx) * (1 - fy) +
           (texel(x0, y1) * (1 - fx) + texel(x1, y1) * fx) * fy;
  }

 private:
  const Vector3f& texel(int x, int y) const { return texels_[static_cast<std::size_t>(y) * width_ + x]; }
  int width_, height_;
  std::vector<Vector3f> texels_;
};

std::vector<Vector3f> rows_of(const Points& points) {
  std::vector<Vector3f> rows(points.rows());
  for (Eigen::Index i = 0; i < points.rows(); ++i) rows[i] = points.row(i).transpose().cast<float>();
  return rows;
}

}  // namespace

struct TracedScene::Impl {
  const Topology* topology;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  float offset = 0.0f;  // mm that leaving rays start above the surface
  std::vector<Vector3f> positions, normals, colours;
  std::optional<AlbedoMap> albedo;
  Vector3f base_colour;
  std::vector<Finish> finishes;
  std::vector<bool> hidden;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  explicit Impl(const Scene& source) : topology(source.topology.get()), base_colour(source.base_colour) {
    source.validate();
    Points local = source.positions;
    if (local.rows() > 0) {
      const Box box = bounds(local);
      centre = box.centre();
      offset = static_cast<float>(1e-5 * box.diagonal());  // 100 times float's resolution at that size
      local.rowwise() -= centre.transpose();
    }
    positions = rows_of(local);
    normals = rows_of(vertex_normals(*topology, local));
    if (!source.albedo.empty()) albedo.emplace(source.albedo);
    colours = rows_of(source.vertex_colours.cwiseMax(0.0).cwiseMin(1.0));
    finishes = source.finishes;
    hidden.assign(positions.size(), false);
    for (const int v : source.hidden_vertices) hidden[v] = true;
    build();
  }
  ~Impl() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void build() {
    const FlushDenormals guard;
    device = rtcNewDevice(nullptr);
    if (!device) throw ToolError("Embree could not start on this processor (it needs SSE2)");
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    const Triangles& triangles = topology->triangles();
    if (triangles.rows() > 0) {
      const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
      auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
          geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), positions.size()));
      auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
          geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), triangles.rows()));
      if (!vertices || !indices) throw Error("Embree could not hold the mesh: not enough memory");
      for (std::size_t v = 0; v < positions.size(); ++v) std::copy_n(positions[v].data(), 3, vertices + 3 * v);
      for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
        const auto corner = triangles.row(t);
        const bool left_out = hidden[corner[0]] && hidden[corner[1]] && hidden[corner[2]];
        // A left-out triangle keeps its number but has no area, so nothing hits it.
        for (int k = 0; k < 3; ++k) indices[3 * t + k] = static_cast<unsigned>(corner[left_out ? 0 : k]);
      }
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(scene, geometry);
      rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene);
  }

  template <class T>
  T interpolated(const std::vector<T>& values, int triangle, const Vector3f& weights) const {
    const auto corner = topology->triangles().row(triangle);
    return weights[0] * values[corner[0]] + weights[1] * values[corner[1]] + weights[2] * values[corner[2]];
  }

  Vector3f albedo_at(int triangle, const Vector3f& weights) const {
    if (albedo) {
      const auto corner = topology->triangle_uvs().row(triangle);
      Eigen::Vector2f uv = Eigen::Vector2f::Zero();
      for (int k = 0; k < 3; ++k) uv += weights[k] * topology->uvs().row(corner[k]).transpose().cast<float>();
      return albedo->at(uv);
    }
    return colours.empty() ? base_colour : interpolated(colours, triangle, weights);
  }

  Finish finish_at(int triangle, const Vector3f& weights) const {
    if (finishes.size() == 1) return finishes.front();
    const auto corner = topology->triangles().row(triangle);
    Finish result{0.0f, 0.0f, 0.0f};
    for (int k = 0; k < 3; ++k) {
      const Finish& f = finishes[corner[k]];
      result.roughness += weights[k] * f.roughness;
      result.ior += weights[k] * f.ior;
      result.specular += weights[k] * f.specular;
    }
    return result;
  }

  /// Hanika 2021, "Hacking the Shadow Terminator": the point moved onto the corners' tangent planes where it lies below
  /// them, so that triangles of a rounded surface do not shadow each other's smooth shading.
  Vector3f lifted_onto_tangents(const Vector3f& position, int triangle, const Vector3f& weights) const {
    const auto corner = topology->triangles().row(triangle);
    Vector3f lift = Vector3f::Zero();
    for (int k = 0; k < 3; ++k) {
      const float below = std::min(0.0f, (position - positions[corner[k]]).dot(normals[corner[k]]));
      lift -= weights[k] * below * normals[corner[k]];
    }
    return position + lift;
  }
};

TracedScene::TracedScene(const Scene& scene) : impl_(std::make_unique<Impl>(scene)) {}
TracedScene::~TracedScene() = default;

const Eigen::Vector3d& TracedScene::centre() const { return impl_->centre; }

namespace {

RTCRay embree_ray(const Ray& ray) {
  RTCRay r{};
  r.org_x = ray.origin.x();
  r.org_y = ray.origin.y();
  r.org_z = ray.origin.z();
  r.dir_x = ray.direction.x();
  r.dir_y = ray.direction.y();
  r.dir_z = ray.direction.z();
  r.tfar = std::numeric_limits<float>::infinity();
  r.mask = ~0u;
  return r;
}

}  // namespace

bool TracedScene::intersect(const Ray& ray, Crossing& crossing) const {
  RTCRayHit query{};
  query.ray = embree_ray(ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(impl_->scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  crossing = {static_cast<int>(query.hit.primID), query.hit.u, query.hit.v, query.ray.tfar};
  return true;
}

bool TracedScene::occluded(const Ray& ray, float max_distance) const {
  RTCRay query = embree_ray(ray);
  query.tfar = max_distance;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(impl_->scene, &context, &query);
  return query.tfar < 0.0f;
}

Surface TracedScene::surface(const Ray& ray, const Crossing& crossing) const {
  const Impl& s = *impl_;
  const Vector3f weights(1.0f - crossing.u - crossing.v, crossing.u, crossing.v);
  const auto corner = s.topology->triangles().row(crossing.triangle);
  const Vector3f &a = s.positions[corner[0]], &b = s.positions[corner[1]], &c = s.positions[corner[2]];

  Surface result;
  result.position = s.interpolated(s.positions, crossing.triangle, weights);
  result.geometric_normal = (b - a).cross(c - a).normalized();
  result.shading_normal = s.interpolated(s.normals, crossing.triangle, weights).normalized();
  result.lifted = result.position;
  if (result.geometric_normal.dot(ray.direction) < 0.0f) {
    result.lifted = s.lifted_onto_tangents(result.position, crossing.triangle, weights);
  } else {  // seen from inside
    result.geometric_normal = -result.geometric_normal;
    result.shading_normal = -result.shading_normal;
  }
  if (!(result.shading_normal.dot(result.geometric_normal) > 0.0f)) result.shading_normal = result.geometric_normal;
  // An interpolated normal may face away from the ray near silhouettes; it is bent until the ray just sees it.
  constexpr float least_cosine = 0.02f;
  const float cosine = -result.shading_normal.dot(ray.direction);
  if (cosine < least_cosine)
    result.shading_normal = (result.shading_normal - (least_cosine - cosine) * ray.direction).normalized();
  result.lifted += s.offset * result.geometric_normal;
  result.albedo = s.albedo_at(crossing.triangle, weights);
  result.finish = s.finish_at(crossing.triangle, weights);
  return result;
}

}  // namespace vultus::render
