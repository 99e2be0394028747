#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh.h"
#include "core/rays.h"

namespace vultus::virtual_stage {

/// One sample of a range image.
struct RangeSample {
  SurfacePoint place;
  Eigen::Vector3d position;  ///< true, mm
  Eigen::Vector3d ray;       ///< unit, from the sensor
  int sensor = -1;
};

/// Ten camera-and-projector pairs around the origin, all looking at it (see `scan_subject`).
class SensorRing {
 public:
  SensorRing(const RayScene& scene, const Topology& topology, const Points& positions);

  /// Samples of every sensor at about `spacing` mm on surfaces that face it (twice that behind the head), each kept by
  /// the sensor that sees it best. Jitter and the orientation of the grids come from `seed`; the order and content do
  /// not depend on the thread count.
  std::vector<RangeSample> samples(double spacing, std::uint64_t seed) const;
  /// A sensor's spacing relative to that of the sensors in front.
  double coarseness(int sensor) const { return sensors_[sensor].coarseness; }

 private:
  struct Sensor {
    Eigen::Vector3d camera, projector;
    Eigen::Vector3d right, up, forward;
    double coarseness;
  };
  std::vector<RangeSample> row(int sensor, int row, int rows, double angle, double roll, std::uint64_t seed) const;
  /// Cosine at `position` for a sensor that sees it, else 0.
  double score(const Sensor& sensor, const Eigen::Vector3d& position, const Eigen::Vector3d& normal) const;
  bool sees_best(int sensor, const Eigen::Vector3d& position, const Eigen::Vector3d& normal) const;

  const RayScene& scene_;
  const Topology& topology_;
  const Points& positions_;
  std::vector<Sensor> sensors_;
};

}  // namespace vultus::virtual_stage
