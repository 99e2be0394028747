#include "apps/virtual_stage/mocap_volume.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "core/error.h"
#include "core/random.h"

namespace vultus::virtual_stage {
namespace {

enum Stream : std::uint64_t { motion_stream = 41, gap_stream = 42, noise_stream = 1000 };

// Smooth wandering: a few slow waves whose sum stays within about ±1.
class Wander {
 public:
  Wander(Random& random, double slowest_hz, double fastest_hz) {
    for (Wave& wave : waves_) {
      wave.hz = random.uniform(slowest_hz, fastest_hz);
      wave.phase = random.uniform(0, 2 * std::numbers::pi);
    }
  }
  double operator()(double time) const {
    double sum = 0;
    for (const Wave& wave : waves_) sum += std::sin(2 * std::numbers::pi * wave.hz * time + wave.phase);
    return sum / 2.4;
  }

 private:
  struct Wave {
    double hz, phase;
  };
  std::array<Wave, 3> waves_;
};

std::vector<Similarity> head_motion(int frames, double rate_hz, const VolumeOptions& options) {
  Random random(options.seed, motion_stream);
  std::array<Wander, 3> turn = {Wander(random, 0.12, 0.6), Wander(random, 0.15, 0.8), Wander(random, 0.1, 0.5)};
  std::array<Wander, 3> shift = {Wander(random, 0.08, 0.35), Wander(random, 0.1, 0.4), Wander(random, 0.08, 0.35)};
  const Eigen::Vector3d neck(0, -105, -75), seat(120, 1260, 240);  // mm: where the head turns, where the actor sits
  constexpr double yaw = 0.33, pitch = 0.22, roll = 0.14;          // radians
  std::vector<Similarity> poses(frames);
  for (int f = 0; f < frames; ++f) {
    const double t = f / rate_hz, amount = options.head_motion;
    Similarity& pose = poses[f];
    pose.rotation = (Eigen::AngleAxisd(amount * yaw * turn[0](t), Eigen::Vector3d::UnitY()) *
                     Eigen::AngleAxisd(amount * pitch * turn[1](t), Eigen::Vector3d::UnitX()) *
                     Eigen::AngleAxisd(amount * roll * turn[2](t), Eigen::Vector3d::UnitZ()))
                        .toRotationMatrix();
    const Eigen::Vector3d sway = amount * Eigen::Vector3d(22 * shift[0](t), 10 * shift[1](t), 18 * shift[2](t));
    pose.translation = seat + sway + neck - pose.rotation * neck;
  }
  return poses;
}

// How squarely each marker faces the cameras in a frame, 0 … 1.
double facing(const Eigen::Vector3d& outward) { return std::clamp(0.5 + 0.5 * outward.z(), 0.0, 1.0); }

void lose_bursts(mocap::Take& take, const std::vector<Similarity>& volume_from_face, const mocap::Take& clean,
                 int first, int last, double share, Random& random) {
  const int frames = take.frames(), markers = last - first;
  if (frames == 0 || markers <= 0) return;
  const double samples = static_cast<double>(frames) * markers;
  std::size_t lost = 0;
  const std::size_t wanted = static_cast<std::size_t>(std::llround(share * samples));
  while (lost < wanted) {
    const int marker = first + random.below(markers), begin = random.below(frames);
    const int length = 3 + static_cast<int>(37 * std::pow(random.uniform(), 2.0));
    const Eigen::Vector3d outward =
        volume_from_face[begin].rotation * (clean.at(begin, marker) + Eigen::Vector3d(0, 0, 40)).normalized();
    if (random.uniform() < 0.85 * facing(outward)) continue;
    for (int f = begin; f < std::min(frames, begin + length) && lost < wanted; ++f) {
      if (!take.has(f, marker)) continue;
      take.drop(f, marker);
      ++lost;
    }
  }
}

void check(bool in_range, const std::string& option, const std::string& range) {
  if (!in_range) throw UsageError("volume option " + option + " must be " + range);
}

}  // namespace

void VolumeOptions::validate() const {
  check(noise >= 0 && noise <= 10, "noise", "0 … 10 mm");
  check(missing >= 0 && missing <= 0.5, "missing", "0 … 0.5");
  check(head_motion >= 0 && head_motion <= 2, "head_motion", "0 … 2");
}

RecordedTake record(const FaceModel& actor, const MarkerLayout& layout, const Performance& performance,
                    const VolumeOptions& options) {
  options.validate();
  const int frames = static_cast<int>(performance.frames.size());
  const int face_markers = static_cast<int>(layout.labels.size()), jig_markers = static_cast<int>(layout.jig.rows());
  std::vector<std::string> labels = layout.labels;
  labels.insert(labels.end(), layout.jig_labels.begin(), layout.jig_labels.end());
  RecordedTake recorded;
  recorded.take = mocap::Take::empty(performance.name, performance.rate_hz, labels, frames);
  recorded.clean = recorded.take;
  recorded.volume_from_face = head_motion(frames, performance.rate_hz, options);

  tbb::parallel_for(0, frames, [&](int f) {
    Points markers(face_markers + jig_markers, 3);
    markers << marker_positions(layout, *actor.topology(), actor.pose(performance.frames[f])), layout.jig;
    Random random(options.seed, noise_stream + f);
    for (Eigen::Index m = 0; m < markers.rows(); ++m) {
      recorded.clean.set(f, static_cast<int>(m), markers.row(m));
      const double x = random.normal(), y = random.normal(), z = random.normal();
      recorded.take.set(
          f, static_cast<int>(m),
          recorded.volume_from_face[f] * Eigen::Vector3d(markers.row(m)) + options.noise * Eigen::Vector3d(x, y, z));
    }
  });
  Random random(options.seed, gap_stream);
  lose_bursts(recorded.take, recorded.volume_from_face, recorded.clean, 0, face_markers, options.missing, random);
  lose_bursts(recorded.take, recorded.volume_from_face, recorded.clean, face_markers, face_markers + jig_markers,
              0.1 * options.missing, random);
  return recorded;
}

double missing_share(const mocap::Take& take, int first, int last) {
  if (take.frames() == 0 || last <= first) return 0.0;
  std::size_t missing = 0;
  for (int f = 0; f < take.frames(); ++f)
    for (int m = first; m < last; ++m) missing += take.has(f, m) ? 0 : 1;
  return static_cast<double>(missing) / (static_cast<double>(take.frames()) * (last - first));
}

}  // namespace vultus::virtual_stage
