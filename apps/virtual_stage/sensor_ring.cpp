#include "apps/virtual_stage/sensor_ring.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/random.h"

namespace vultus::virtual_stage {
namespace {

constexpr double distance_to_subject = 650.0;  // mm
constexpr double half_field = 0.27;            // radians: a head with its neck and the way it may be turned
constexpr double projector_angle = 0.21;       // between camera and projector as seen from the subject, radians
constexpr double smallest_cosine = 0.26;       // 75°

struct Direction {
  double azimuth, elevation;  // degrees; 0, 0 is in front
  double coarseness;
};
constexpr Direction directions[] = {{-22, 4, 1},  {24, 6, 1},     {-68, 8, 1},   {66, 5, 1},    {0, -38, 1},
                                    {3, 52, 1.3}, {-118, 6, 1.6}, {121, 4, 1.6}, {-164, 12, 2}, {160, 48, 2}};

Eigen::Vector3d on_sphere(double azimuth, double elevation) {
  return {std::sin(azimuth) * std::cos(elevation), std::sin(elevation), std::cos(azimuth) * std::cos(elevation)};
}

}  // namespace

SensorRing::SensorRing(const RayScene& scene, const Topology& topology, const Points& positions)
    : scene_(scene), topology_(topology), positions_(positions) {
  for (const Direction& d : directions) {
    const double azimuth = d.azimuth * std::numbers::pi / 180, elevation = d.elevation * std::numbers::pi / 180;
    Sensor sensor;
    sensor.camera = distance_to_subject * on_sphere(azimuth, elevation);
    const double side = d.azimuth < 0 ? 1.0 : -1.0;
    sensor.projector = distance_to_subject * on_sphere(azimuth + side * projector_angle, elevation);
    sensor.forward = -sensor.camera.normalized();
    sensor.right = sensor.forward.cross(Eigen::Vector3d::UnitY()).normalized();
    sensor.up = sensor.right.cross(sensor.forward);
    sensor.coarseness = d.coarseness;
    sensors_.push_back(sensor);
  }
}

double SensorRing::score(const Sensor& sensor, const Eigen::Vector3d& position, const Eigen::Vector3d& normal) const {
  constexpr double lift = 0.02;  // mm, so that the surface does not hide itself
  const Eigen::Vector3d origin = position + lift * normal;
  double cosine = 1.0;
  for (const Eigen::Vector3d& eye : {sensor.camera, sensor.projector}) {
    const Eigen::Vector3d towards = (eye - position).normalized();
    cosine = std::min(cosine, normal.dot(towards));
    if (cosine < smallest_cosine) return 0.0;
  }
  for (const Eigen::Vector3d& eye : {sensor.camera, sensor.projector})
    if (scene_.occluded(origin, eye - origin, 0.0, (eye - origin).norm())) return 0.0;
  return cosine;
}

bool SensorRing::sees_best(int sensor, const Eigen::Vector3d& position, const Eigen::Vector3d& normal) const {
  const double own = score(sensors_[sensor], position, normal);
  if (own <= 0.0) return false;
  for (int other = 0; other < static_cast<int>(sensors_.size()); ++other) {
    if (other == sensor) continue;
    const Eigen::Vector3d towards = (sensors_[other].camera - position).normalized();
    if (normal.dot(towards) <= own) continue;  // its score can only be lower: no rays needed
    const double theirs = score(sensors_[other], position, normal);
    if (theirs > own) return false;
  }
  return true;
}

std::vector<RangeSample> SensorRing::row(int sensor_index, int row, int rows, double angle, double roll,
                                         std::uint64_t seed) const {
  const Sensor& sensor = sensors_[sensor_index];
  Random random(seed, static_cast<std::uint64_t>(sensor_index) * 100'003 + row);
  const Eigen::AngleAxisd turn(roll, sensor.forward);
  const Eigen::Vector3d right = turn * sensor.right, up = turn * sensor.up;
  std::vector<RangeSample> kept;
  for (int column = 0; column < rows; ++column) {
    constexpr double jitter = 0.35;  // of a cell: keeps neighbours apart and the lattice from showing
    const double x = (column - 0.5 * rows + random.uniform(-jitter, jitter) + 0.5 * (row % 2)) * angle;
    const double y = (row - 0.5 * rows + random.uniform(-jitter, jitter)) * angle;
    const Eigen::Vector3d ray = (sensor.forward + x * right + y * up).normalized();
    const std::optional<RayHit> hit = scene_.hit(sensor.camera, ray);
    if (!hit) continue;
    const auto corners = topology_.triangles().row(hit->place.triangle);
    const Eigen::Vector3d a = positions_.row(corners[0]), b = positions_.row(corners[1]),
                          c = positions_.row(corners[2]);
    const Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
    const Eigen::Vector3d position = position_of(hit->place, topology_, positions_);
    if (sees_best(sensor_index, position, normal)) kept.push_back({hit->place, position, ray, sensor_index});
  }
  return kept;
}

std::vector<RangeSample> SensorRing::samples(double spacing, std::uint64_t seed) const {
  struct Row {
    int sensor, row, rows;
    double angle, roll;
  };
  std::vector<Row> tasks;
  Random random(seed, 1);
  for (int s = 0; s < static_cast<int>(sensors_.size()); ++s) {
    const double angle = spacing * sensors_[s].coarseness / distance_to_subject;
    const int rows = static_cast<int>(2 * half_field / angle) + 1;
    const double roll = random.uniform(-0.4, 0.4);
    for (int r = 0; r < rows; ++r) tasks.push_back({s, r, rows, angle, roll});
  }
  std::vector<std::vector<RangeSample>> parts(tasks.size());
  tbb::parallel_for(std::size_t{0}, tasks.size(), [&](std::size_t i) {
    const Row& task = tasks[i];
    parts[i] = row(task.sensor, task.row, task.rows, task.angle, task.roll, seed);
  });
  std::vector<RangeSample> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace vultus::virtual_stage
