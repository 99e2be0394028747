#include "apps/virtual_stage/scanner.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "apps/virtual_stage/point_surface.h"
#include "apps/virtual_stage/random_pose.h"
#include "apps/virtual_stage/scan_clutter.h"
#include "apps/virtual_stage/sensor_ring.h"
#include "core/error.h"
#include "core/random.h"
#include "core/rays.h"

namespace vultus::virtual_stage {
namespace {

// Streams of the seed, so that turning one effect off leaves the others as they were.
enum Stream : std::uint64_t { pose_stream = 11, noise_stream, patch_stream, clutter_stream };

void expect(bool in_range, const std::string& option, const std::string& range) {
  if (!in_range) throw UsageError("scan option " + option + " must be " + range);
}

// Grid spacing that yields half as many samples as triangles are asked, from a coarse trial.
double spacing_for(const SensorRing& ring, const ScanOptions& options) {
  double spacing = 6.0;  // mm
  for (int trial = 0; trial < 2; ++trial) {
    const double found = static_cast<double>(ring.samples(spacing, options.seed).size());
    if (found < 16) throw InputError("scan subject: no sensor sees enough of it");
    const double wanted =
        trial == 0 ? 0.02 * options.triangles + 400 : 0.5 * options.triangles / (1.0 - options.dropout);
    spacing *= std::sqrt(found / wanted);
  }
  return spacing;
}

double hair_at(const ScanSubject& subject, const SurfacePoint& place) {
  if (subject.hair.size() == 0) return 0.0;
  const auto corners = subject.surface.topology->triangles().row(place.triangle);
  double value = 0.0;
  for (int c = 0; c < 3; ++c) value += place.barycentric[c] * subject.hair[corners[c]];
  return std::clamp(value, 0.0, 1.0);
}

// Takes out round patches of 1.5 to 4 mm until the asked fraction is gone.
void drop_patches(std::vector<RangeSample>& samples, const ScanOptions& options) {
  Random random(options.seed, patch_stream);
  const std::size_t to_drop = static_cast<std::size_t>(options.dropout * static_cast<double>(samples.size()));
  std::size_t dropped = 0;
  while (dropped < to_drop) {
    const Eigen::Vector3d centre = samples[random.below(static_cast<int>(samples.size()))].position;
    const double radius = random.uniform(1.5, 4.0);
    dropped += std::erase_if(samples, [&](const RangeSample& s) { return (s.position - centre).norm() < radius; });
  }
}

// Dark, glossy, thin: the projected pattern is lost on most of a hair style.
void lose_hair(std::vector<RangeSample>& samples, const ScanSubject& subject, const ScanOptions& options) {
  if (subject.hair.size() == 0) return;
  Random random(options.seed, patch_stream + 100);
  std::erase_if(samples, [&](const RangeSample& s) { return random.uniform() < 0.45 * hair_at(subject, s.place); });
}

Points measured(const std::vector<RangeSample>& samples, const ScanSubject& subject, const ScanOptions& options) {
  Random random(options.seed, noise_stream);
  Points points(samples.size(), 3);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    double error = options.noise * (1.0 + 9.0 * hair_at(subject, samples[i].place)) * random.normal();
    const bool spike = random.uniform() < options.spikes;
    const double throw_of = random.uniform(-5.0, 5.0);
    if (spike) error += throw_of;
    points.row(i) = (samples[i].position + error * samples[i].ray).transpose();
  }
  return points;
}

// Albedo under the room's light, which the scanner's camera does not take out.
Points seen_colours(const std::vector<RangeSample>& samples, const ScanSubject& subject, const Points& placed) {
  const Mesh& surface = subject.surface;
  if (!surface.has_colours()) return Points(0, 3);
  const Points normals = vertex_normals(*surface.topology, placed);
  const Eigen::Vector3d light = Eigen::Vector3d(0.2, 0.6, 0.8).normalized();
  Points colours(samples.size(), 3);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Eigen::Vector3d albedo = position_of(samples[i].place, *surface.topology, surface.colours);
    const Eigen::Vector3d normal = position_of(samples[i].place, *surface.topology, normals).normalized();
    const double shade = 0.72 + 0.28 * std::max(0.0, normal.dot(light));
    colours.row(i) = (shade * albedo).cwiseMax(0.0).cwiseMin(1.0).transpose();
  }
  return colours;
}

int root(std::vector<int>& parent, int v) {
  while (parent[v] != v) v = parent[v] = parent[parent[v]];
  return v;
}

// A surface that was seen faces who saw it: each connected part is turned the way most of its triangles look at their
// sensors, since the front's own orientation is arbitrary for an open surface.
void face_sensors(Triangles& triangles, const Points& points, const std::vector<RangeSample>& samples) {
  std::vector<int> parent(points.rows());
  std::iota(parent.begin(), parent.end(), 0);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t)
    for (int c = 1; c < 3; ++c) parent[root(parent, triangles(t, c))] = root(parent, triangles(t, 0));
  std::vector<double> outward(points.rows(), 0.0);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::Vector3d a = points.row(triangles(t, 0)), b = points.row(triangles(t, 1)),
                          c = points.row(triangles(t, 2));
    outward[root(parent, triangles(t, 0))] -= (b - a).cross(c - a).dot(samples[triangles(t, 0)].ray);
  }
  for (Eigen::Index t = 0; t < triangles.rows(); ++t)
    if (outward[root(parent, triangles(t, 0))] < 0) std::swap(triangles(t, 1), triangles(t, 2));
}

// Drops vertices that no triangle uses, so that the file holds a mesh and not a cloud around it.
void keep_used(Scan& scan, Triangles& triangles) {
  std::vector<int> new_index(scan.mesh.positions.rows(), -1);
  for (Eigen::Index i = 0; i < triangles.size(); ++i) new_index[triangles.data()[i]] = 0;
  int count = 0;
  const bool coloured = scan.mesh.colours.rows() > 0;
  for (std::size_t v = 0; v < new_index.size(); ++v) {
    if (new_index[v] < 0) continue;
    scan.mesh.positions.row(count) = scan.mesh.positions.row(v).eval();
    if (coloured) scan.mesh.colours.row(count) = scan.mesh.colours.row(v).eval();
    scan.truth[count] = scan.truth[v];
    new_index[v] = count++;
  }
  scan.mesh.positions.conservativeResize(count, 3);
  if (coloured) scan.mesh.colours.conservativeResize(count, 3);
  scan.truth.resize(count);
  for (Eigen::Index i = 0; i < triangles.size(); ++i) triangles.data()[i] = new_index[triangles.data()[i]];
  scan.mesh.topology = Topology::from_triangles(count, triangles);
}

}  // namespace

void ScanOptions::validate() const {
  expect(triangles >= 1'000 && triangles <= 10'000'000, "triangles", "1,000 … 10,000,000");
  expect(noise >= 0 && noise <= 5, "noise", "0 … 5 mm");
  expect(spikes >= 0 && spikes <= 0.1, "spikes", "0 … 0.1");
  expect(dropout >= 0 && dropout <= 0.5, "dropout", "0 … 0.5");
  expect(max_rotation >= 0 && max_rotation <= 0.8, "max_rotation", "0 … 0.8 radians");
  expect(max_translation >= 0 && max_translation <= 150, "max_translation", "0 … 150 mm");
}

Scan scan_subject(const ScanSubject& subject, const ScanOptions& options) {
  options.validate();
  Scan scan;
  scan.scan_from_face = random_pose(Random(options.seed, pose_stream), options.max_rotation, options.max_translation);
  const Topology& topology = *subject.surface.topology;
  const Points placed = transformed(scan.scan_from_face, subject.surface.positions);
  const RayScene scene(topology, placed);
  const SensorRing ring(scene, topology, placed);

  const double spacing = spacing_for(ring, options);
  std::vector<RangeSample> samples = ring.samples(spacing, options.seed);
  lose_hair(samples, subject, options);
  drop_patches(samples, options);

  scan.mesh.positions = measured(samples, subject, options);
  scan.mesh.colours = seen_colours(samples, subject, placed);
  for (const RangeSample& sample : samples) scan.truth.push_back(sample.place);
  constexpr double bridged = 3.2;  // spacings: wide enough to join jittered neighbours, narrow enough to leave holes
  std::vector<double> reach;
  for (const RangeSample& sample : samples) reach.push_back(bridged * spacing * ring.coarseness(sample.sensor));
  Triangles triangles = surface_through(scan.mesh.positions, reach);
  face_sensors(triangles, scan.mesh.positions, samples);
  keep_used(scan, triangles);
  if (options.clutter) {
    Random random(options.seed, clutter_stream);
    add_clutter(scan, subject, random);
  }
  return scan;
}

}  // namespace vultus::virtual_stage
