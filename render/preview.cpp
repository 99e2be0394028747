#include "render/preview.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/flush_denormals.h"
#include "render/sampler.h"
#include "render/traced_scene.h"

namespace vultus::render {
namespace {

using Eigen::Vector3f;

constexpr float occlusion_distance = 40.0f;  // mm: nostrils, ears, lips

Points colours_of(const Mesh& mesh, const PreviewOptions& options) {
  if (!options.field) return mesh.has_colours() ? mesh.colours : Points(0, 3);
  const VertexField& field = *options.field;
  if (static_cast<Eigen::Index>(field.values.size()) != mesh.positions.rows())
    throw InputError("preview: " + std::to_string(field.values.size()) + " values for " +
                     std::to_string(mesh.positions.rows()) + " vertices");
  if (!(field.high > field.low)) throw InputError("preview: the legend's high end must lie above its low end");
  Points colours(mesh.positions.rows(), 3);
  for (Eigen::Index v = 0; v < colours.rows(); ++v) {
    const double t = (field.values[v] - field.low) / (field.high - field.low);
    colours.row(v) = mapped_colour(field.map, t).cast<double>().transpose();
  }
  return colours;
}

/// Direction about `n` with density cos/π.
Vector3f cosine_direction(const Vector3f& n, const Eigen::Vector2f& u) {
  const float z = 1.0f - 2.0f * u.x(), r = std::sqrt(std::max(0.0f, 1.0f - z * z));
  const float phi = 2.0f * std::numbers::pi_v<float> * u.y();
  return (n + 0.999f * Vector3f(r * std::cos(phi), r * std::sin(phi), z)).normalized();
}

class Shader {
 public:
  Shader(const Camera& camera, const TracedScene& scene, const PreviewOptions& options)
      : camera_(camera), scene_(scene), options_(options) {
    eye_ = (camera.centre() - scene.centre()).cast<float>();
    const Eigen::Matrix3f axes = camera.camera_from_world_rotation.cast<float>();
    key_ = (-axes.row(2) - 0.55f * axes.row(1) - 0.45f * axes.row(0)).transpose().normalized();
    up_ = -axes.row(1).transpose();
  }

  /// Colour and coverage of one sample.
  Eigen::Vector4f sample(int x, int y, Sampler& sampler) const {
    const Eigen::Vector2f jitter = sampler.next_2d();
    const Ray ray{eye_, camera_.direction(x + jitter.x(), y + jitter.y()).cast<float>()};
    Crossing crossing;
    if (!scene_.intersect(ray, crossing)) return Eigen::Vector4f::Zero();
    const Surface surface = scene_.surface(ray, crossing);
    const Vector3f& n = surface.shading_normal;
    const bool open = !scene_.occluded({surface.lifted, cosine_direction(n, sampler.next_2d())}, occlusion_distance);
    const float ambient = open ? 0.42f + 0.10f * n.dot(up_) : 0.0f;
    const float shade = ambient + 0.62f * std::max(0.0f, n.dot(key_));
    const float contrast = static_cast<float>(options_.contrast);
    const Vector3f colour = surface.albedo * (1.0f - contrast + contrast * shade);
    return {colour.x(), colour.y(), colour.z(), 1.0f};
  }

 private:
  const Camera& camera_;
  const TracedScene& scene_;
  const PreviewOptions& options_;
  Vector3f eye_, key_, up_;
};

void store(const Eigen::Vector4f& sum, const PreviewOptions& options, float* pixel) {
  const float coverage = sum.w() / static_cast<float>(options.samples);
  Vector3f colour = sum.w() > 0.0f ? Vector3f(sum.head<3>() / sum.w()) : Vector3f(Vector3f::Zero());
  if (options.background)
    colour = coverage * colour + (1.0f - coverage) * *options.background;
  else
    pixel[3] = coverage;
  for (int c = 0; c < 3; ++c) pixel[c] = colour[c];
}

}  // namespace

Image render_preview(const Mesh& mesh, const Camera& camera, const PreviewOptions& options) {
  if (options.samples < 1 || options.samples > 256) throw UsageError("preview samples must be 1 to 256");
  if (!(options.contrast >= 0.0 && options.contrast <= 1.0)) throw UsageError("preview contrast must be 0 to 1");
  Scene scene;
  scene.topology = mesh.topology;
  scene.positions = mesh.positions;
  scene.vertex_colours = colours_of(mesh, options);
  scene.base_colour = options.colour;
  scene.hidden_vertices = options.hidden_vertices;
  scene.camera = camera;
  scene.environment = std::make_shared<Environment>(Environment::constant(Vector3f::Ones()));
  const TracedScene traced(scene);
  const Shader shader(camera, traced, options);
  std::vector<std::string> channels{"R", "G", "B"};
  if (!options.background) channels.push_back("A");
  Image image(camera.width, camera.height, std::move(channels));
  tbb::parallel_for(0, camera.height, [&](int y) {
    const FlushDenormals guard;
    for (int x = 0; x < camera.width; ++x) {
      Sampler sampler(1, static_cast<std::uint64_t>(y) << 32 | static_cast<std::uint32_t>(x));
      Eigen::Vector4f sum = Eigen::Vector4f::Zero();
      for (int s = 0; s < options.samples; ++s) {
        sampler.start(static_cast<std::uint32_t>(s));
        sum += shader.sample(x, y, sampler);
      }
      store(sum, options, image.at(x, y));
    }
  });
  return image;
}

}  // namespace vultus::render
