#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "core/random.h"
#include "mocap/take.h"
#include "retarget/weights.h"
#include "rig/actor.h"

namespace vultus::retarget::testing {

/// A curved 160×160 mm patch standing for a face: +y up, facing +z, x the subject's left. Its poses are symmetric, as a
/// scan session's are: one moves two bumps at (±x, y) by the same amount, mirrored.
class SmallFace {
 public:
  static constexpr int kSide = 33;  // vertices a side

  /// `columns`×`rows` regions with borders as soft as `softness` mm (0: hard).
  static rig::Actor actor(int columns = 2, int rows = 1, double softness = 15.0) {
    rig::Actor actor;
    actor.name = "patch";
    actor.topology = topology();
    actor.poses.push_back({"neutral", {}, neutral()});
    actor.poses.push_back({"smile", {}, moved(40, -40, {14, 8, 2}, 30)});
    actor.poses.push_back({"pucker", {}, moved(25, -40, {-9, 0, 8}, 25)});
    actor.poses.push_back({"brows_up", {}, moved(35, 45, {0, 11, 3}, 30)});
    actor.poses.push_back({"brows_down", {}, moved(30, 40, {-4, -8, 2}, 25)});
    actor.poses.push_back({"jaw_open", {}, moved(0, -70, {0, -12, -3}, 40)});
    add_regions(actor, columns, rows, softness);
    return actor;
  }

  /// count×count markers spread over the patch, off the vertices.
  static std::vector<SurfacePoint> places(int count) {
    std::vector<SurfacePoint> result;
    for (int j = 0; j < count; ++j) {
      for (int i = 0; i < count; ++i) {
        const int column = 1 + i * (kSide - 4) / (count - 1), row = 1 + j * (kSide - 4) / (count - 1);
        const int quad = row * (kSide - 1) + column;
        result.push_back({2 * quad + (i + j) % 2, Eigen::Vector3d(0.5, 0.3, 0.2)});
      }
    }
    return result;
  }

  static std::vector<std::string> labels(std::size_t count) {
    std::vector<std::string> result;
    for (std::size_t i = 0; i < count; ++i) result.push_back("M" + std::to_string(i));
    return result;
  }

  static Points positions(const rig::Actor& actor, const std::vector<SurfacePoint>& places, const Points& pose) {
    Points result(static_cast<Eigen::Index>(places.size()), 3);
    for (std::size_t i = 0; i < places.size(); ++i) {
      result.row(static_cast<Eigen::Index>(i)) = position_of(places[i], *actor.topology, pose).transpose();
    }
    return result;
  }

  static mocap::Take take(const std::vector<std::string>& labels, const std::vector<Points>& frames) {
    mocap::Take take = mocap::Take::empty("test", 60.0, labels, static_cast<int>(frames.size()));
    for (std::size_t f = 0; f < frames.size(); ++f) {
      for (std::size_t q = 0; q < labels.size(); ++q) {
        take.set(static_cast<int>(f), static_cast<int>(q), frames[f].row(static_cast<Eigen::Index>(q)).transpose());
      }
    }
    return take;
  }

  /// Weights in which the left and the right half do different things, smooth in time.
  static Weights asymmetric(const rig::Actor& actor, int frames, std::uint64_t seed) {
    std::vector<std::string> regions;
    for (const rig::Region& region : actor.regions) regions.push_back(region.name);
    Weights weights = Weights::zeros(60.0, regions, actor.pose_names(), frames);
    Random random(seed);
    const std::size_t poses = actor.poses.size();
    std::vector<double> phase, speed;
    for (std::size_t i = 0; i < regions.size() * poses; ++i) {
      phase.push_back(random.uniform(0.0, 6.28));
      speed.push_back(random.uniform(0.02, 0.1));
    }
    for (int f = 0; f < frames; ++f) {
      for (std::size_t k = 0; k < regions.size(); ++k) {
        double sum = 0.0;
        std::vector<double> row(poses);
        for (std::size_t i = 0; i < poses; ++i) {
          const std::size_t n = k * poses + i;
          row[i] = std::max(0.0, std::sin(phase[n] + speed[n] * f));
          sum += row[i];
        }
        row[0] += 0.2;
        sum += 0.2;
        for (std::size_t i = 0; i < poses; ++i) {
          weights.at(f, static_cast<int>(k))[i] = static_cast<float>(row[i] / sum);
        }
      }
    }
    return weights;
  }

 private:
  static constexpr double kHalf = 80.0;

  static std::shared_ptr<const Topology> topology() {
    TopologyData data;
    data.vertex_count = kSide * kSide;
    data.uvs.resize(data.vertex_count, 2);
    for (int v = 0; v < data.vertex_count; ++v) {
      data.uvs.row(v) << (v % kSide) / (kSide - 1.0) * 0.9 + 0.05, (v / kSide) / (kSide - 1.0) * 0.9 + 0.05;
    }
    data.face_offsets.push_back(0);
    for (int j = 0; j + 1 < kSide; ++j) {
      for (int i = 0; i + 1 < kSide; ++i) {
        const int v = j * kSide + i;
        for (int corner : {v, v + 1, v + kSide + 1, v + kSide}) data.corner_vertex.push_back(corner);
        data.face_offsets.push_back(static_cast<int>(data.corner_vertex.size()));
      }
    }
    data.corner_uv = data.corner_vertex;
    data.landmarks = {{"corner_left", kSide - 1}, {"corner_right", 0}, {"nose", kSide * kSide / 2},
                      {"top", kSide * kSide - 1 - kSide / 2}, {"bottom", kSide / 2}};
    return Topology::make(std::move(data));
  }

  static Points neutral() {
    Points points(kSide * kSide, 3);
    for (int v = 0; v < kSide * kSide; ++v) {
      const double x = (2.0 * (v % kSide) / (kSide - 1) - 1.0) * kHalf;
      const double y = (2.0 * (v / kSide) / (kSide - 1) - 1.0) * kHalf;
      points.row(v) << x, y, -(x * x + 0.5 * y * y) / 150.0;
    }
    return points;
  }

  static Points moved(double x, double y, const Eigen::Vector3d& motion, double radius) {
    Points points = neutral();
    for (Eigen::Index v = 0; v < points.rows(); ++v) {
      const Eigen::Vector3d p = points.row(v).transpose();
      for (double side : {-1.0, 1.0}) {
        const double distance = (p.head<2>() - Eigen::Vector2d(side * x, y)).squaredNorm();
        const double amount = std::exp(-distance / (radius * radius));
        points.row(v) += amount * Eigen::RowVector3d(side * motion.x(), motion.y(), motion.z());
      }
    }
    return points;
  }

  static double soft_step(double x, double softness) {
    if (softness <= 0.0) return x >= 0.0 ? 1.0 : 0.0;
    return 0.5 * (1.0 + std::tanh(x / softness));
  }

  static void add_regions(rig::Actor& actor, int columns, int rows, double softness) {
    const Points& points = actor.neutral();
    const auto share = [&](double x, int cell, int cells) {
      const double width = 2.0 * kHalf / cells, low = -kHalf + cell * width;
      const double above = cell == 0 ? 1.0 : soft_step(x - low, softness);
      const double next = cell + 1 == cells ? 0.0 : soft_step(x - low - width, softness);
      return above - next;
    };
    for (int j = 0; j < rows; ++j) {
      for (int i = 0; i < columns; ++i) {
        rig::Region region{"R" + std::to_string(j) + std::to_string(i), Eigen::VectorXf(points.rows())};
        for (Eigen::Index v = 0; v < points.rows(); ++v) {
          region.vertex_mask[v] = static_cast<float>(share(points(v, 0), i, columns) * share(points(v, 1), j, rows));
        }
        actor.regions.push_back(std::move(region));
      }
    }
  }
};

}  // namespace vultus::retarget::testing
