#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/flush_denormals.h"
#include "render/path_tracer.h"

namespace vultus::render {
namespace {

using Eigen::Vector3f;

/// Latitude-longitude sphere of 50 mm about the origin.
Mesh sphere(int rows = 48) {
  const int columns = 2 * rows;
  Mesh mesh;
  mesh.positions.resize((rows + 1) * columns, 3);
  Triangles triangles(2 * rows * columns, 3);
  int t = 0;
  for (int r = 0; r <= rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const double theta = std::numbers::pi * r / rows, phi = 2 * std::numbers::pi * c / columns;
      mesh.positions.row(r * columns + c) =
          50.0 * Eigen::RowVector3d(std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi));
      if (r == rows) continue;
      const int a = r * columns + c, b = r * columns + (c + 1) % columns;
      triangles.row(t++) << a, a + columns, b;
      triangles.row(t++) << b, a + columns, b + columns;
    }
  mesh.topology = Topology::from_triangles(static_cast<int>(mesh.positions.rows()), triangles);
  return mesh;
}

Scene scene_of(const Mesh& mesh, Environment environment, Vector3f albedo, Finish finish = {0.5f, 1.4f, 0.0f}) {
  Scene scene;
  scene.topology = mesh.topology;
  scene.positions = mesh.positions;
  scene.base_colour = albedo;
  scene.finishes = {finish};
  scene.environment = std::make_shared<Environment>(std::move(environment));
  scene.camera = Camera::look_at({0, 0, 400}, {0, 0, 0}, {0, 1, 0}, 0.3, 32, 32);
  return scene;
}

/// Mean of a channel over pixels the mesh covers wholly.
double mean_of_covered(const Image& layers, int channel) {
  double total = 0;
  int count = 0;
  for (int y = 0; y < layers.height(); ++y)
    for (int x = 0; x < layers.width(); ++x)
      if (layers.at(x, y)[3] == 1.0f) {
        total += layers.at(x, y)[channel];
        ++count;
      }
  EXPECT_GT(count, 100);
  return total / count;
}

double rms_difference(const Image& a, const Image& b) {
  double total = 0;
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x) total += (a.rgb_at(x, y) - b.rgb_at(x, y)).squaredNorm();
  return std::sqrt(total / (3.0 * a.width() * a.height()));
}

PathTracerOptions with_samples(int samples, std::uint64_t seed = 1) {
  PathTracerOptions options;
  options.samples = samples;
  options.seed = seed;
  return options;
}

TEST(PathTracer, WhiteLambertSphereVanishesInAWhiteFurnace) {
  const Scene scene = scene_of(sphere(), Environment::constant({1, 1, 1}), {1, 1, 1});
  const PathTracerResult result = trace_paths(scene, with_samples(64));
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      // Every path brings between 0 and 2; 64 of them, stratified. The faceted silhouette loses what its shading
      // normals send below the facets.
      EXPECT_NEAR(result.layers.rgb_at(x, y)[1], 1.0f, 0.12f) << x << " " << y;
    }
  EXPECT_NEAR(mean_of_covered(result.layers, 1), 1.0, 0.005);
}

TEST(PathTracer, WhiteCoatedSphereVanishesInAWhiteFurnace) {
  for (const float roughness : {0.3f, 0.8f}) {
    const Scene scene = scene_of(sphere(), Environment::constant({1, 1, 1}), {1, 1, 1}, {roughness, 1.4f, 1.0f});
    EXPECT_NEAR(mean_of_covered(trace_paths(scene, with_samples(64)).layers, 1), 1.0, 0.01) << roughness;
  }
}

TEST(PathTracer, InsideOfABowlVanishesToo) {
  // Half a sphere seen from its open side: light bounces many times, and none is lost.
  Mesh bowl = sphere();
  std::vector<bool> keep(bowl.positions.rows());
  for (Eigen::Index v = 0; v < bowl.positions.rows(); ++v) keep[v] = bowl.positions(v, 2) < 1e-9;
  Scene scene = scene_of(sub_mesh(bowl, keep).mesh, Environment::constant({1, 1, 1}), {1, 1, 1});
  PathTracerOptions options = with_samples(64);
  options.bounces = 64;
  EXPECT_NEAR(mean_of_covered(trace_paths(scene, options).layers, 1), 1.0, 0.01);
  options.bounces = 1;  // direct light only
  EXPECT_LT(mean_of_covered(trace_paths(scene, options).layers, 1), 0.7);
}

TEST(PathTracer, GreySphereReturnsItsAlbedo) {
  const Scene scene = scene_of(sphere(), Environment::constant({2, 1, 0.5f}), {0.5f, 0.3f, 0.1f});
  const Image layers = trace_paths(scene, with_samples(64)).layers;
  EXPECT_NEAR(mean_of_covered(layers, 0), 1.0, 0.005);
  EXPECT_NEAR(mean_of_covered(layers, 1), 0.3, 0.002);
  EXPECT_NEAR(mean_of_covered(layers, 2), 0.05, 0.0005);
}

/// ∫ L max(0, n·w) dw over the 0.3 rad about `lamp` in latitude and longitude, outside of which it is dark.
double irradiance(const Environment& environment, const Eigen::Vector3d& normal, const Eigen::Vector3d& lamp) {
  constexpr int steps = 300;
  constexpr double span = 0.3, cell = span * span / (steps * steps);
  const double theta0 = std::acos(lamp.y()), phi0 = std::atan2(lamp.x(), lamp.z());
  double total = 0;
  for (int r = 0; r < steps; ++r)
    for (int c = 0; c < steps; ++c) {
      const double theta = theta0 + span * ((r + 0.5) / steps - 0.5), phi = phi0 + span * ((c + 0.5) / steps - 0.5);
      const Eigen::Vector3d w(std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi));
      total += environment.radiance(w.cast<float>())[0] * std::max(0.0, normal.dot(w)) * std::sin(theta) * cell;
    }
  return total;
}

Eigen::Vector3d normal_of(const float* pixel) { return {pixel[7], pixel[8], pixel[9]}; }

TEST(PathTracer, SmallLampGivesLambertsCosine) {
  // Two texels of a 128×64 map, 45 degrees above the camera's axis. Radiance is albedo/π times the irradiance.
  Image map = Image::rgb(128, 64);
  map.set_rgb(0, 16, {500, 500, 500});
  map.set_rgb(127, 16, {500, 500, 500});
  const Environment lamp(map);
  Scene scene = scene_of(sphere(96), lamp, {0.6f, 0.6f, 0.6f});
  scene.camera = Camera::look_at({0, 0, 4000}, {0, 0, 0}, {0, 1, 0}, 0.03, 3, 33);
  const Image layers = trace_paths(scene, with_samples(4096)).layers;
  for (const int y : {6, 10, 16, 20}) {
    const float* pixel = layers.at(1, y);
    ASSERT_EQ(pixel[3], 1.0f);
    const double expected =
        0.6 / std::numbers::pi * irradiance(lamp, normal_of(pixel), {0, std::sqrt(0.5), std::sqrt(0.5)});
    EXPECT_NEAR(pixel[0], expected, 0.01 * expected + 1e-4) << y;  // noise of 4096 paths
  }
}

TEST(PathTracer, LayersDescribeTheSurface) {
  Scene scene = scene_of(sphere(), Environment::constant({1, 1, 1}), {0.5f, 0.3f, 0.1f});
  scene.camera = Camera::look_at({0, 0, 400}, {0, 0, 0}, {0, 1, 0}, 0.5, 33, 33);
  const Image layers = trace_paths(scene, with_samples(16)).layers;
  const float* centre = layers.at(16, 16);
  EXPECT_EQ(centre[3], 1.0f);
  EXPECT_NEAR(centre[4], 0.5f, 1e-6f);
  EXPECT_NEAR(centre[6], 0.1f, 1e-6f);
  EXPECT_NEAR(centre[9], 1.0f, 1e-2f);    // the normal faces the camera
  EXPECT_NEAR(centre[10], 350.0f, 0.5f);  // 400 - 50 mm; the pixel spans 6 mm of the sphere's curve
  const float* corner = layers.at(0, 0);
  for (int c = 3; c < 11; ++c) EXPECT_EQ(corner[c], 0.0f);
  EXPECT_EQ(corner[0], 1.0f);  // the environment itself
  scene.backdrop = Vector3f(0.2f, 0.1f, 0.3f);
  EXPECT_EQ(trace_paths(scene, with_samples(1)).layers.rgb_at(0, 0), Vector3f(0.2f, 0.1f, 0.3f));
}

TEST(PathTracer, PixelsDoNotDependOnThreads) {
  Scene scene = scene_of(sphere(), Environment::studio(), {0.6f, 0.4f, 0.3f}, {0.4f, 1.4f, 1.0f});
  scene.camera = Camera::look_at({0, 0, 400}, {0, 0, 0}, {0, 1, 0}, 0.3, 61, 45);  // tiles that are cut off
  const auto with_threads = [&](int threads) {
    Image layers;
    tbb::task_arena(threads).execute([&] { layers = trace_paths(scene, with_samples(8)).layers; });
    return layers;
  };
  const Image one = with_threads(1);
  EXPECT_EQ(one.pixels(), with_threads(2).pixels());
}

TEST(PathTracer, SeedsGiveOtherNoiseOfTheSamePicture) {
  const Scene scene = scene_of(sphere(), Environment::studio(), {0.6f, 0.4f, 0.3f}, {0.4f, 1.4f, 1.0f});
  const Image a = trace_paths(scene, with_samples(16, 1)).layers,
              again = trace_paths(scene, with_samples(16, 1)).layers;
  const Image b = trace_paths(scene, with_samples(16, 2)).layers;
  EXPECT_EQ(a.pixels(), again.pixels());
  EXPECT_NE(a.pixels(), b.pixels());
  EXPECT_NEAR(mean_of_covered(a, 1), mean_of_covered(b, 1), 0.02 * mean_of_covered(a, 1));
}

TEST(PathTracer, ErrorFallsAsTheSquareRootOfSamplesOrFaster) {
  const Scene scene = scene_of(sphere(), Environment::studio(), {0.6f, 0.4f, 0.3f}, {0.4f, 1.4f, 1.0f});
  const Image truth = trace_paths(scene, with_samples(1024, 99)).layers;
  const double at_8 = rms_difference(trace_paths(scene, with_samples(8)).layers, truth);
  const double at_128 = rms_difference(trace_paths(scene, with_samples(128)).layers, truth);
  EXPECT_LT(at_128, at_8 / 4 * 1.15);  // sixteen times the samples; the truth has noise of its own
  EXPECT_GT(at_128, 0.0);
}

TEST(PathTracer, NoiseTargetStopsEarlyAndIsMet) {
  const Scene scene = scene_of(sphere(), Environment::studio(), {0.6f, 0.4f, 0.3f}, {0.5f, 1.4f, 1.0f});
  PathTracerOptions options = with_samples(2048);
  options.noise_target = 0.05;
  const PathTracerResult result = trace_paths(scene, options);
  EXPECT_LT(result.paths, 32u * 32u * 1024u);
  EXPECT_GE(result.paths, 32u * 32u * 32u);
  const Image truth = trace_paths(scene, with_samples(1024, 5)).layers;
  EXPECT_LT(rms_difference(result.layers, truth) / mean_of_covered(truth, 1), 2 * options.noise_target);
}

TEST(PathTracer, ClampBoundsEveryPath) {
  Image map = Image::rgb(64, 32);
  map.set_rgb(0, 10, {50000, 50000, 50000});
  Scene scene = scene_of(sphere(), Environment(map), {0.6f, 0.4f, 0.3f}, {0.1f, 1.4f, 1.0f});
  PathTracerOptions options = with_samples(8);
  options.clamp = 0.5f;
  const Image layers = trace_paths(scene, options).layers;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) EXPECT_LE(layers.rgb_at(x, y).maxCoeff(), 0.5001f);
}

TEST(PathTracer, SmoothShadingHasNoTerminatorSteps) {
  // A coarse sphere lit from the side: its facets of 18 degrees must not cut the smooth falloff at the terminator.
  Image map = Image::rgb(64, 32);
  map.set_rgb(48, 15, {400, 400, 400});  // towards +x
  map.set_rgb(48, 16, {400, 400, 400});
  const Environment lamp(map);
  Scene scene = scene_of(sphere(10), lamp, {0.8f, 0.8f, 0.8f});
  scene.camera = Camera::look_at({0, 0, 4000}, {0, 0, 0}, {0, 1, 0}, 0.03, 65, 3);
  scene.camera.fx = scene.camera.fy = 65 * scene.camera.fy / 3;
  const Image layers = trace_paths(scene, with_samples(2048)).layers;
  for (int x = 25; x < 55; ++x) {
    const float* pixel = layers.at(x, 1);
    const double expected = 0.8 / std::numbers::pi * irradiance(lamp, normal_of(pixel), {1, 0, 0});
    // Normals vary within a pixel by up to 3 degrees; where facets shadow, 0.03 and more is missing.
    EXPECT_NEAR(pixel[0], expected, 0.012) << x;
  }
}

class CancelAfter final : public Progress {
 public:
  explicit CancelAfter(int tiles) : left_(tiles) {}
  void begin(std::string_view, std::size_t) override {}
  void advance(std::size_t) override { --left_; }
  void note(std::string_view) override {}
  bool cancelled() const override { return left_ <= 0; }

 private:
  std::atomic<int> left_;
};

TEST(PathTracer, StopsWhenCancelled) {
  const Scene scene = scene_of(sphere(), Environment::constant({1, 1, 1}), {0.5f, 0.5f, 0.5f});
  CancelAfter progress(2);
  EXPECT_THROW(trace_paths(scene, with_samples(4), progress), Cancelled);
}

TEST(PathTracer, RefusesBadOptionsAndScenes) {
  const Scene good = scene_of(sphere(8), Environment::constant({1, 1, 1}), {0.5f, 0.5f, 0.5f});
  EXPECT_THROW(trace_paths(good, with_samples(0)), UsageError);
  PathTracerOptions options;
  options.bounces = 65;
  EXPECT_THROW(trace_paths(good, options), UsageError);
  options = {};
  options.noise_target = std::nan("");
  EXPECT_THROW(trace_paths(good, options), UsageError);
  options = {};
  options.clamp = -1;
  EXPECT_THROW(trace_paths(good, options), UsageError);

  Scene scene = good;
  scene.positions(3, 0) = std::nan("");
  EXPECT_THROW(trace_paths(scene, {}), InputError);
  scene = good;
  scene.albedo = Image::rgb(4, 4);  // no UVs
  EXPECT_THROW(trace_paths(scene, {}), InputError);
  scene = good;
  scene.finishes = {Finish{2.0f, 1.4f, 1.0f}};
  EXPECT_THROW(trace_paths(scene, {}), InputError);
  scene = good;
  scene.finishes.resize(3);
  EXPECT_THROW(trace_paths(scene, {}), InputError);
  scene = good;
  scene.vertex_colours = Points::Zero(2, 3);
  EXPECT_THROW(trace_paths(scene, {}), InputError);
  scene = good;
  scene.environment.reset();
  EXPECT_THROW(trace_paths(scene, {}), InputError);
  scene = good;
  scene.camera.width = 0;
  EXPECT_THROW(trace_paths(scene, {}), InputError);
}

TEST(FlushDenormals, HoldsWhileItLives) {
  const volatile float tiny = 1e-38f;
  EXPECT_NE(tiny * 0.01f, 0.0f);
  {
    const FlushDenormals guard;
    const volatile float product = tiny * 0.01f;
    EXPECT_EQ(product, 0.0f);
  }
  EXPECT_NE(tiny * 0.01f, 0.0f);
}

}  // namespace
}  // namespace vultus::render
