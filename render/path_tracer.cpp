#include "render/path_tracer.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/error.h"
#include "core/flush_denormals.h"
#include "render/bsdf.h"
#include "render/sampler.h"
#include "render/traced_scene.h"

namespace vultus::render {
namespace {

using Eigen::Vector3f;

constexpr int tile_side = 16;
constexpr int samples_between_checks = 32;  // of the noise target
constexpr int roulette_from = 3;            // interactions every path may have

struct Counts {
  std::uint64_t rays = 0, paths = 0, rejected = 0;
};

/// Orthonormal frame about a unit z (Duff et al. 2017).
struct Frame {
  Vector3f x, y, z;
  explicit Frame(const Vector3f& n) : z(n) {
    const float sign = std::copysign(1.0f, n.z()), a = -1.0f / (sign + n.z()), b = n.x() * n.y() * a;
    x = {1.0f + sign * n.x() * n.x() * a, sign * b, -sign * n.x()};
    y = {b, sign + n.y() * n.y() * a, -n.y()};
  }
  Vector3f local(const Vector3f& w) const { return {w.dot(x), w.dot(y), w.dot(z)}; }
  Vector3f world(const Vector3f& l) const { return l.x() * x + l.y() * y + l.z() * z; }
};

/// Weight of a sample drawn with density p where q could have drawn it too (Veach 1997, power heuristic).
float mis_weight(float p, float q) {
  const float p2 = p * p, q2 = q * q;
  return p2 > 0.0f ? p2 / (p2 + q2) : 0.0f;
}

Skin skin_of(const Surface& surface) {
  return {surface.albedo, alpha_from_roughness(surface.finish.roughness),
          surface.finish.specular * f0_from_ior(surface.finish.ior), surface.finish.specular};
}

/// Inverse of the distribution function of the tent on [-1, 1].
float tent(float u) { return u < 0.5f ? std::sqrt(2.0f * u) - 1.0f : 1.0f - std::sqrt(2.0f - 2.0f * u); }

class Tracer {
 public:
  Tracer(const Scene& scene, const TracedScene& traced, const PathTracerOptions& options)
      : scene_(scene), traced_(traced), options_(options) {
    eye_ = (scene.camera.centre() - traced.centre()).cast<float>();
    axis_ = scene.camera.camera_from_world_rotation.row(2).transpose().cast<float>();
    focal_ = Eigen::Vector2d(scene.camera.fx, scene.camera.fy).cast<float>();
    world_from_camera_ = scene.camera.camera_from_world_rotation.transpose().cast<float>();
  }

  PathSample sample(int x, int y, Sampler& sampler, Counts& counts) const {
    const Eigen::Vector2f jitter = sampler.next_2d();
    const Vector3f in_camera((static_cast<float>(x - scene_.camera.cx) + 0.5f + tent(jitter.x())) / focal_.x(),
                             (static_cast<float>(y - scene_.camera.cy) + 0.5f + tent(jitter.y())) / focal_.y(), 1.0f);
    PathSample result = path({eye_, (world_from_camera_ * in_camera).normalized()}, sampler, counts);
    ++counts.paths;
    if (!result.radiance.allFinite()) {
      ++counts.rejected;
      result.radiance.setZero();
    }
    if (options_.clamp > 0.0f) {
      const float largest = result.radiance.maxCoeff();
      if (largest > options_.clamp) result.radiance *= options_.clamp / largest;
    }
    return result;
  }

 private:
  PathSample path(Ray ray, Sampler& sampler, Counts& counts) const {
    PathSample result;
    Vector3f throughput = Vector3f::Ones();
    float last_pdf = 0.0f;
    for (int interactions = 0;; ++interactions) {
      Crossing crossing;
      ++counts.rays;
      if (!traced_.intersect(ray, crossing)) {
        result.radiance += throughput.cwiseProduct(escaped(ray.direction, interactions, last_pdf));
        break;
      }
      if (interactions == options_.bounces) break;
      const Surface surface = traced_.surface(ray, crossing);
      if (interactions == 0) {
        result.covered = true;
        result.albedo = surface.albedo;
        result.normal = surface.shading_normal;
        result.depth = crossing.distance * ray.direction.dot(axis_);
      }
      const Frame frame(surface.shading_normal);
      const Bsdf bsdf(skin_of(surface), frame.local(-ray.direction));
      result.radiance += throughput.cwiseProduct(direct_light(surface, bsdf, frame, sampler, counts));

      const float choice = sampler.next_1d();
      const Vector3f wi = bsdf.sample(choice, sampler.next_2d());
      const Vector3f direction = frame.world(wi);
      last_pdf = bsdf.pdf(wi);
      if (!(last_pdf > 0.0f)) break;
      throughput = throughput.cwiseProduct(bsdf.value(wi)) * (wi.z() / last_pdf);
      if (interactions >= roulette_from) {
        const float survival = std::min(0.95f, throughput.maxCoeff());
        if (sampler.next_1d() >= survival) break;
        throughput /= survival;
      }
      ray = {surface.lifted, direction.normalized()};
    }
    return result;
  }

  /// Light from outside along a ray that left the scene.
  Vector3f escaped(const Vector3f& direction, int interactions, float last_pdf) const {
    if (interactions == 0) return scene_.backdrop ? *scene_.backdrop : scene_.environment->radiance(direction);
    return scene_.environment->radiance(direction) * mis_weight(last_pdf, scene_.environment->pdf(direction));
  }

  Vector3f direct_light(const Surface& surface, const Bsdf& bsdf, const Frame& frame, Sampler& sampler,
                        Counts& counts) const {
    const Environment::Sample light = scene_.environment->sample(sampler.next_2d());
    const Vector3f wi = frame.local(light.direction);
    if (!(light.pdf > 0.0f) || wi.z() <= 0.0f) return Vector3f::Zero();
    const Vector3f arriving =
        bsdf.value(wi).cwiseProduct(light.radiance) * (wi.z() * mis_weight(light.pdf, bsdf.pdf(wi)) / light.pdf);
    if (arriving.isZero(0.0f)) return Vector3f::Zero();
    ++counts.rays;
    if (traced_.occluded({surface.lifted, light.direction})) return Vector3f::Zero();
    return arriving;
  }

  const Scene& scene_;
  const TracedScene& traced_;
  const PathTracerOptions& options_;
  Vector3f eye_, axis_;
  Eigen::Matrix3f world_from_camera_;
  Eigen::Vector2f focal_;  // pixels
};

struct Tile {
  int x0, y0, x1, y1;
};

std::vector<Tile> tiles_of(int width, int height) {
  std::vector<Tile> tiles;
  for (int y = 0; y < height; y += tile_side)
    for (int x = 0; x < width; x += tile_side)
      tiles.push_back({x, y, std::min(x + tile_side, width), std::min(y + tile_side, height)});
  return tiles;
}

/// Root mean square over the tile of each pixel's standard error relative to its luminance.
bool quiet_enough(const std::vector<PixelSum>& sums, double noise_target) {
  constexpr double floor = 0.01;  // near black, noise is judged against this radiance
  double total = 0.0;
  for (const PixelSum& sum : sums) {
    const double scale = std::max(sum.luminance(), floor);
    total += sum.squared_error() / (scale * scale);
  }
  return total / static_cast<double>(sums.size()) <= noise_target * noise_target;
}

Counts trace_tile(const Tracer& tracer, const PathTracerOptions& options, const Tile& tile, Image& layers) {
  const FlushDenormals guard;
  Counts counts;
  const int columns = tile.x1 - tile.x0;
  std::vector<PixelSum> sums(static_cast<std::size_t>(columns) * (tile.y1 - tile.y0));
  const auto pixel_of = [&](std::size_t i) {
    return std::pair(tile.x0 + static_cast<int>(i) % columns, tile.y0 + static_cast<int>(i) / columns);
  };
  const int pass = options.noise_target > 0.0 ? samples_between_checks : options.samples;
  for (int first = 0; first < options.samples; first += pass) {
    const int last = std::min(first + pass, options.samples);
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const auto [x, y] = pixel_of(i);
      Sampler sampler(options.seed, static_cast<std::uint64_t>(y) << 32 | static_cast<std::uint32_t>(x));
      for (int s = first; s < last; ++s) {
        sampler.start(static_cast<std::uint32_t>(s));
        sums[i].add(tracer.sample(x, y, sampler, counts));
      }
    }
    if (options.noise_target > 0.0 && quiet_enough(sums, options.noise_target)) break;
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const auto [x, y] = pixel_of(i);
    sums[i].store(layers.at(x, y));
  }
  return counts;
}

}  // namespace

void PathTracerOptions::validate() const {
  if (samples < 1 || samples > 65536) throw UsageError("samples a pixel must be 1 to 65536");
  if (bounces < 1 || bounces > 64) throw UsageError("bounces must be 1 to 64");
  if (!(noise_target >= 0.0) || noise_target >= 1.0) throw UsageError("the noise target must be 0 (off) to below 1");
  if (!(clamp >= 0.0f)) throw UsageError("the radiance clamp must be 0 (off) or more");
}

PathTracerResult trace_paths(const Scene& scene, const PathTracerOptions& options, Progress& progress) {
  options.validate();
  const TracedScene traced(scene);
  const Tracer tracer(scene, traced, options);
  PathTracerResult result;
  result.layers = make_layers(scene.camera.width, scene.camera.height);
  const std::vector<Tile> tiles = tiles_of(scene.camera.width, scene.camera.height);
  progress.begin("path tracing", tiles.size());
  std::atomic<std::uint64_t> rays = 0, paths = 0, rejected = 0;  // integers: their sum has no order
  tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t t) {
    progress.check();
    const Counts counts = trace_tile(tracer, options, tiles[t], result.layers);
    rays += counts.rays;
    paths += counts.paths;
    rejected += counts.rejected;
    progress.advance();
  });
  result.rays = rays;
  result.paths = paths;
  result.rejected_paths = rejected;
  return result;
}

}  // namespace vultus::render
