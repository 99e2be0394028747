#include "apps/bench_registration/resample.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <climits>
#include <cmath>
#include <string>

#include "apps/virtual_stage/random_pose.h"
#include "core/error.h"
#include "core/random.h"
#include "core/rays.h"

namespace vultus::apps::bench {
namespace {

enum Stream : std::uint64_t { pose_stream = 1, hole_stream, noise_stream, row_stream = 1000 };

void expect(bool in_range, const std::string& option, const std::string& range) {
  if (!in_range) throw UsageError("test scan: " + option + " must be " + range);
}

/// Rays about an upright axis inside the head. Rows rise along the axis and tilt from upward-looking rays that see
/// under the chin to downward-looking ones that see the crown: they spread outwards and never cross.
struct RayFan {
  Eigen::Vector2d axis;      // x, z
  double low = 0, high = 0;  // where the rows' rays leave the axis
  double start = 0;          // mm from the axis, outside everything

  struct Ray {
    Eigen::Vector3d origin, direction;  // inwards, unit
  };
  Ray at(double row, double column) const {                       // both 0 … 1
    constexpr double lowest = -1.05, highest = 1.05, side = 2.1;  // radians
    const double elevation = lowest + (highest - lowest) * row, around = side * (2.0 * column - 1.0);
    const Eigen::Vector3d outward(std::cos(elevation) * std::sin(around), std::sin(elevation),
                                  std::cos(elevation) * std::cos(around));
    const Eigen::Vector3d from(axis.x(), low + (high - low) * row, axis.y());
    return {from + start * outward, -outward};
  }
};

RayFan fan_about(const Mesh& surface, const std::vector<int>& face) {
  const Box box = bounds(surface.positions(face, Eigen::all));
  const double height = box.max.y() - box.min.y();
  constexpr double nose_to_axis = 110.0;  // mm
  RayFan fan;
  fan.axis = {box.centre().x(), box.max.z() - nose_to_axis};
  fan.low = box.min.y() + 0.35 * height;
  fan.high = box.min.y() + 0.75 * height;
  fan.start = bounds(surface.positions).diagonal() + 200.0;
  return fan;
}

struct Sample {
  SurfacePoint place;
  Eigen::Vector3d position, ray;
  int vertex = -1;
};

using Grid = std::vector<std::vector<Sample>>;  // samples that met nothing have no place

std::vector<Sample> cast_row(const Mesh& surface, const RayScene& scene, const RayFan& fan, double bottom,
                             std::uint64_t seed, int row, int rows, int columns) {
  Random random(seed, row_stream + static_cast<std::uint64_t>(row));
  const Triangles& triangles = surface.topology->triangles();
  std::vector<Sample> samples(static_cast<std::size_t>(columns));
  for (int column = 0; column < columns; ++column) {
    const double r = (row + random.uniform(0.05, 0.95)) / rows, c = (column + random.uniform(0.05, 0.95)) / columns;
    const RayFan::Ray ray = fan.at(r, c);
    const auto hit = scene.hit(ray.origin, ray.direction, 0.0, fan.start - 10.0);
    if (!hit) continue;
    const Eigen::Vector3d position = ray.origin + hit->distance * ray.direction;
    if (position.y() < bottom) continue;
    const auto corner = triangles.row(hit->place.triangle);
    const Eigen::Vector3d a = surface.positions.row(corner[0]), b = surface.positions.row(corner[1]),
                          d = surface.positions.row(corner[2]);
    const Eigen::Vector3d normal = (b - a).cross(d - a);
    // Grazed surface is no measurement; a back side is a place that no scanner sees.
    if (normal.dot(ray.direction) > -0.1 * normal.norm()) continue;
    samples[static_cast<std::size_t>(column)] = {hit->place, position, ray.direction};
  }
  return samples;
}

Grid cast(const Mesh& surface, const RayScene& scene, const RayFan& fan, double bottom, std::uint64_t seed, int rows,
          int columns) {
  Grid grid(static_cast<std::size_t>(rows));
  tbb::parallel_for(0, rows, [&](int row) {
    grid[static_cast<std::size_t>(row)] = cast_row(surface, scene, fan, bottom, seed, row, rows, columns);
  });
  return grid;
}

std::vector<Sample*> met(Grid& grid) {
  std::vector<Sample*> samples;
  for (auto& row : grid)
    for (Sample& sample : row)
      if (sample.place.valid()) samples.push_back(&sample);
  return samples;
}

void drop_patches(Grid& grid, const ResampleOptions& options) {
  Random random(options.seed, hole_stream);
  std::vector<Sample*> samples = met(grid);
  auto left = static_cast<std::ptrdiff_t>(options.holes * static_cast<double>(samples.size()));
  while (left > 0) {
    const Eigen::Vector3d centre = samples[random.below(static_cast<int>(samples.size()))]->position;
    const double radius = options.hole_radius * random.uniform(0.5, 1.0);
    for (Sample* sample : samples) {
      if (left <= 0) break;
      if (!sample->place.valid() || (sample->position - centre).squaredNorm() > radius * radius) continue;
      sample->place = {};
      --left;
    }
  }
}

void number_vertices(Grid& grid, ResampledScan& scan, const ResampleOptions& options) {
  Random random(options.seed, noise_stream);
  const std::vector<Sample*> samples = met(grid);
  scan.mesh.positions.resize(static_cast<Eigen::Index>(samples.size()), 3);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i]->vertex = static_cast<int>(i);
    scan.places.push_back(samples[i]->place);
    const Eigen::Vector3d seen = samples[i]->position + options.noise * random.normal() * samples[i]->ray;
    scan.mesh.positions.row(static_cast<Eigen::Index>(i)) = seen;
  }
}

constexpr int widest_slit = 2;  // rows of samples that may be missing between joined ones

// A pattern projected into a slit is not seen: samples deep behind what lies close above and below are lost.
void lose_slits(Grid& grid, double reach) {
  const auto placed = [&](std::size_t row, std::size_t column) { return grid[row][column].place.valid(); };
  const auto apart = [&](std::size_t row, std::size_t other, std::size_t column) {
    return (grid[row][column].position - grid[other][column].position).norm() > reach;
  };
  for (std::size_t column = 0; column < grid.front().size(); ++column)
    for (std::size_t low = 0; low + 2 < grid.size(); ++low)
      for (std::size_t high = low + 2; high < std::min<std::size_t>(grid.size(), low + 2 + widest_slit); ++high) {
        if (!placed(low, column) || !placed(high, column) || apart(low, high, column)) continue;
        for (std::size_t row = low + 1; row < high; ++row)
          if (placed(row, column) && apart(row, low, column) && apart(row, high, column)) grid[row][column].place = {};
      }
}

// Strips of triangles between neighbouring columns: always on to the next sample of the column that is behind, of two
// at one height along the shorter diagonal; over missing samples where they are few.
Triangles joined(const Grid& grid, const Points& positions, double reach) {
  std::vector<Eigen::RowVector3i> triangles;
  std::vector<std::vector<int>> rows(grid.front().size());  // of the samples that are there, by column
  for (std::size_t row = 0; row < grid.size(); ++row)
    for (std::size_t column = 0; column < rows.size(); ++column)
      if (grid[row][column].vertex >= 0) rows[column].push_back(static_cast<int>(row));
  const auto distance = [&](int a, int b) { return (positions.row(a) - positions.row(b)).norm(); };
  for (std::size_t column = 0; column + 1 < rows.size(); ++column) {
    const std::vector<int>&left = rows[column], &right = rows[column + 1];
    const auto vertex = [&](int row, std::size_t at) { return grid[static_cast<std::size_t>(row)][at].vertex; };
    for (std::size_t i = 0, j = 0; i < left.size() && j < right.size();) {
      const int a = vertex(left[i], column), b = vertex(right[j], column + 1);
      const int up_left = i + 1 < left.size() ? left[i + 1] : INT_MAX;
      const int up_right = j + 1 < right.size() ? right[j + 1] : INT_MAX;
      if (up_left == INT_MAX && up_right == INT_MAX) break;
      bool go_left = up_left < up_right;
      if (up_left == up_right)
        go_left = distance(vertex(up_left, column), b) < distance(vertex(up_right, column + 1), a);
      const int next = go_left ? up_left : up_right, c = vertex(next, go_left ? column : column + 1);
      const int lowest = std::min(left[i], right[j]);
      if (next - lowest <= widest_slit + 1 && std::max({distance(a, b), distance(b, c), distance(c, a)}) < reach)
        triangles.emplace_back(a, b, c);
      ++(go_left ? i : j);
    }
  }
  Triangles result(static_cast<Eigen::Index>(triangles.size()), 3);
  for (std::size_t i = 0; i < triangles.size(); ++i) result.row(static_cast<Eigen::Index>(i)) = triangles[i];
  return result;
}

// Usual distance of neighbours in a row.
double spacing_of(const Grid& grid) {
  std::vector<double> steps;
  for (const auto& row : grid)
    for (std::size_t c = 0; c + 1 < row.size(); ++c)
      if (row[c].place.valid() && row[c + 1].place.valid())
        steps.push_back((row[c].position - row[c + 1].position).norm());
  if (steps.empty()) throw InputError("test scan: hardly a ray meets the surface");
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
  return steps[steps.size() / 2];
}

}  // namespace

void ResampleOptions::validate() const {
  expect(triangles >= 1'000 && triangles <= 10'000'000, "triangles", "1,000 … 10,000,000");
  expect(noise >= 0 && noise <= 5, "noise", "0 … 5 mm");
  expect(holes >= 0 && holes <= 0.5, "holes", "0 … 0.5");
  expect(hole_radius > 0, "hole_radius", "positive");
  expect(max_rotation >= 0 && max_rotation <= 3.2, "max_rotation", "0 … 3.2 radians");
  expect(max_shift >= 0, "max_shift", "0 or more");
}

ResampledScan resample(const Mesh& surface, const std::vector<int>& face, const ResampleOptions& options) {
  options.validate();
  const RayScene scene(*surface.topology, surface.positions);
  const RayFan fan = fan_about(surface, face);
  const double bottom = bounds(surface.positions(face, Eigen::all)).min.y() - options.neck;

  // Rows span about 280 mm of a head, columns 400 mm. A coarse trial tells how many rays meet something.
  constexpr double aspect = 1.45;
  constexpr int trial = 100;
  Grid coarse = cast(surface, scene, fan, bottom, options.seed, trial, static_cast<int>(aspect * trial));
  const double share = static_cast<double>(met(coarse).size()) / (aspect * trial * trial);
  if (share < 0.02) throw InputError("test scan: hardly a ray meets the surface");
  const double wanted = 0.5 * options.triangles / (1.0 - options.holes) / share;
  const int rows = std::max(2, static_cast<int>(std::lround(std::sqrt(wanted / aspect))));
  Grid grid = cast(surface, scene, fan, bottom, options.seed, rows, static_cast<int>(std::lround(aspect * rows)));
  constexpr double bridged = 6.0;  // spacings: joins grazed neighbours and closed lips, leaves openings open
  const double reach = bridged * spacing_of(grid);
  lose_slits(grid, reach);
  drop_patches(grid, options);

  ResampledScan scan;
  number_vertices(grid, scan, options);
  const Triangles triangles = joined(grid, scan.mesh.positions, reach);
  scan.scan_from_surface =
      virtual_stage::random_pose(Random(options.seed, pose_stream), options.max_rotation, options.max_shift);
  scan.mesh.positions = transformed(scan.scan_from_surface, scan.mesh.positions);
  scan.mesh.topology = Topology::from_triangles(static_cast<int>(scan.mesh.positions.rows()), triangles);
  return scan;
}

}  // namespace vultus::apps::bench
