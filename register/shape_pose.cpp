#include "register/shape_pose.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/neighbours.h"
#include "core/random.h"
#include "register/align.h"

namespace vultus::registration {
namespace {

// Points spread evenly over a surface, with normals.
struct Samples {
  Points positions, normals;
};

constexpr double nose_radius = 22.0;  // mm about a tip in which its standing out is measured

Samples samples_of(const Mesh& mesh, const std::vector<bool>& keep_vertex, int count) {
  const Triangles& triangles = mesh.topology->triangles();
  const Points normals = vertex_normals(*mesh.topology, mesh.positions);
  std::vector<double> until;
  std::vector<int> used;
  double area = 0.0;
  for (int t = 0; t < triangles.rows(); ++t) {
    const auto corners = triangles.row(t);
    if (!keep_vertex.empty() && !(keep_vertex[corners[0]] && keep_vertex[corners[1]] && keep_vertex[corners[2]]))
      continue;
    const Eigen::Vector3d a = mesh.positions.row(corners[0]), b = mesh.positions.row(corners[1]),
                          c = mesh.positions.row(corners[2]);
    area += 0.5 * (b - a).cross(c - a).norm();
    until.push_back(area);
    used.push_back(t);
  }
  Samples samples{Points(used.empty() ? 0 : count, 3), Points(used.empty() ? 0 : count, 3)};
  Random random(7);
  for (int i = 0; i < samples.positions.rows(); ++i) {
    // Stratified along the running area: the same everywhere, and no clumps within a triangle strip.
    const double at = area * (i + random.uniform()) / count;
    const auto t =
        std::min<std::size_t>(std::upper_bound(until.begin(), until.end(), at) - until.begin(), used.size() - 1);
    const double u = std::sqrt(random.uniform()), v = random.uniform();
    const SurfacePoint place{used[t], {1.0 - u, u * (1.0 - v), u * v}};
    samples.positions.row(i) = position_of(place, *mesh.topology, mesh.positions);
    samples.normals.row(i) = position_of(place, *mesh.topology, normals).normalized();
  }
  return samples;
}

// How a point stands out of its surroundings: in which direction, and by what share of the radius.
struct Tip {
  Eigen::Vector3d position, direction;
  double height;
};

Tip tip_at(const Samples& samples, const PointTree& tree, const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), facing = Eigen::Vector3d::Zero();
  int count = 0;
  for (const auto& neighbour : tree.nearest(point, 120)) {
    if (neighbour.distance > nose_radius) break;
    mean += samples.positions.row(neighbour.index);
    facing += samples.normals.row(neighbour.index);
    ++count;
  }
  if (count < 6 || facing.norm() < 0.2 * count) return {point, normal, 0.0};
  const Eigen::Vector3d outward = facing.normalized();
  return {point, outward, (point - mean / count).dot(outward) / nose_radius};
}

std::vector<Tip> tips_of(const Samples& samples, const PointTree& tree, int most) {
  const int count = static_cast<int>(samples.positions.rows());
  std::vector<Tip> tips(count);
  tbb::parallel_for(0, count,
                    [&](int i) { tips[i] = tip_at(samples, tree, samples.positions.row(i), samples.normals.row(i)); });
  std::stable_sort(tips.begin(), tips.end(), [](const Tip& a, const Tip& b) { return a.height > b.height; });
  std::vector<Tip> apart;
  for (const Tip& tip : tips) {
    if (static_cast<int>(apart.size()) == most || tip.height < 0.1) break;
    if (std::none_of(apart.begin(), apart.end(),
                     [&](const Tip& other) { return (other.position - tip.position).norm() < 0.6 * nose_radius; }))
      apart.push_back(tip);
  }
  return apart;
}

// The face's points, their normals and what the scan offers them: one alignment problem.
struct Problem {
  const Samples& face;
  const Samples& scan;
  const PointTree& tree;
};

// Squared distances beyond `reach` count as nothing; normals that disagree do not count either.
double score_of(const Problem& problem, const Similarity& motion, double reach) {
  double sum = 0.0;
  for (int i = 0; i < problem.face.positions.rows(); ++i) {
    const Eigen::Vector3d moved = motion * Eigen::Vector3d(problem.face.positions.row(i));
    const auto near = problem.tree.nearest(moved, 1).front();
    const Eigen::Vector3d normal = problem.scan.normals.row(near.index), place = problem.scan.positions.row(near.index);
    // Along the normal, as samples have gaps between them.
    const double away = std::abs(normal.dot(moved - place));
    if (near.distance > 3.0 * reach) continue;
    const double turned = std::max(0.0, normal.dot(motion.rotation * problem.face.normals.row(i).transpose()));
    sum += turned * turned * std::exp(-std::pow(away / reach, 2));
  }
  return sum / static_cast<double>(problem.face.positions.rows());
}

Similarity closer(const Problem& problem, Similarity motion, int rounds) {
  const Eigen::Index count = problem.face.positions.rows();
  Points target(count, 3);
  Eigen::VectorXd weights(count);
  for (int round = 0; round < rounds; ++round) {
    const double reach = 25.0 - 15.0 * round / std::max(1, rounds - 1);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Vector3d moved = motion * Eigen::Vector3d(problem.face.positions.row(i));
      const auto near = problem.tree.nearest(moved, 1).front();
      const Eigen::Vector3d normal = problem.scan.normals.row(near.index);
      const Eigen::Vector3d place = problem.scan.positions.row(near.index);
      const double turned = normal.dot(motion.rotation * problem.face.normals.row(i).transpose());
      // Half the way to the plane, half to the point: sliding is free enough, drifting is not.
      const Eigen::Vector3d on_plane = moved - normal * normal.dot(moved - place);
      target.row(i) = 0.5 * (on_plane + place);
      weights[i] = turned > 0.3 ? std::exp(-std::pow(near.distance / reach, 2)) : 1e-6;
    }
    if (weights.sum() < 12.0) return motion;
    motion = fit_similarity(problem.face.positions, target, Scaling::fixed, weights);
  }
  return motion;
}

Similarity tip_onto_tip(const Tip& face, const Tip& scan, double roll) {
  Similarity motion;
  motion.rotation = Eigen::AngleAxisd(roll, scan.direction) *
                    Eigen::Quaterniond::FromTwoVectors(face.direction, scan.direction).normalized().toRotationMatrix();
  motion.translation = scan.position - motion.rotation * face.position;
  return motion;
}

struct Start {
  Similarity motion;
  double score;
};

void keep_best(std::vector<Start>& starts, std::size_t most) {
  std::stable_sort(starts.begin(), starts.end(), [](const Start& a, const Start& b) { return a.score > b.score; });
  if (starts.size() > most) starts.resize(most);
}

void improve(const Problem& problem, std::vector<Start>& starts, int rounds, double reach) {
  tbb::parallel_for(std::size_t{0}, starts.size(), [&](std::size_t i) {
    if (rounds > 0) starts[i].motion = closer(problem, starts[i].motion, rounds);
    starts[i].score = score_of(problem, starts[i].motion, reach);
  });
}

bool same_pose(const Similarity& a, const Similarity& b, const Eigen::Vector3d& point) {
  return (a * point - b * point).norm() < 15.0 && Eigen::AngleAxisd(a.rotation.transpose() * b.rotation).angle() < 0.4;
}

std::vector<bool> near_the_nose(const Mesh& face, const std::vector<int>& skin, int nose_tip, double radius) {
  std::vector<bool> keep(face.positions.rows(), false);
  for (int v : skin) keep[v] = (face.positions.row(v) - face.positions.row(nose_tip)).norm() < radius;
  return keep;
}

std::vector<int> indices(const std::vector<bool>& keep, std::size_t about) {
  std::vector<int> all;
  for (int v = 0; v < static_cast<int>(keep.size()); ++v)
    if (keep[v]) all.push_back(v);
  const std::size_t step = std::max<std::size_t>(1, all.size() / about);
  std::vector<int> some;
  for (std::size_t i = 0; i < all.size(); i += step) some.push_back(all[i]);
  return some;
}

}  // namespace

std::optional<ShapePose> find_shape_pose(const Mesh& face, const std::vector<int>& skin, int nose_tip,
                                         const ScanSurface& scan) {
  const std::vector<bool> middle = near_the_nose(face, skin, nose_tip, 85.0);
  const Samples around_nose = samples_of(face, near_the_nose(face, skin, nose_tip, 60.0), 1500);
  const Samples points = samples_of(face, middle, 240), surface = samples_of(scan.mesh(), {}, 6000);
  if (points.positions.rows() == 0 || surface.positions.rows() == 0) return {};
  const PointTree nose_tree(around_nose.positions), tree(surface.positions);
  const Eigen::Vector3d nose = face.positions.row(nose_tip);
  const Tip own = tip_at(around_nose, nose_tree, nose, Eigen::Vector3d::UnitZ());
  const Problem problem{points, surface, tree};

  std::vector<Start> starts;
  for (const Tip& tip : tips_of(surface, tree, 30))
    for (int roll = 0; roll < 16; ++roll) starts.push_back({tip_onto_tip(own, tip, roll * M_PI / 8.0), 0.0});
  if (starts.empty()) return {};
  improve(problem, starts, 0, 12.0);
  keep_best(starts, 90);
  improve(problem, starts, 6, 8.0);
  keep_best(starts, 16);
  improve(problem, starts, 12, 4.0);
  keep_best(starts, 16);

  // The few that are left slide on the scan itself, with a size of their own.
  const std::vector<int> vertices = indices(middle, 800);
  std::vector<Start> poses;
  for (const Start& start : starts) {
    if (std::any_of(poses.begin(), poses.end(),
                    [&](const Start& other) { return same_pose(other.motion, start.motion, nose); }))
      continue;
    if (poses.size() == 6) break;
    poses.push_back(start);
  }
  tbb::parallel_for(std::size_t{0}, poses.size(), [&](std::size_t i) {
    const Alignment aligned =
        align_surface(*face.topology, face.positions, vertices, scan, poses[i].motion, Scaling::free);
    const double scale = aligned.scan_from_template.scale;
    if (aligned.rms >= 0.0 && scale > 0.7 && scale < 1.4) poses[i].motion = aligned.scan_from_template;
    poses[i].score = score_of(problem, poses[i].motion, 3.0);
  });
  keep_best(poses, poses.size());
  ShapePose result{poses.front().motion, poses.front().score, 0.0};
  for (const Start& other : poses)
    if (!same_pose(other.motion, result.scan_from_face, nose))
      result.runner_up = std::max(result.runner_up, other.score);
  return result;
}

}  // namespace vultus::registration
