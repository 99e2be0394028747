#include "rig/segmentation.h"

#include <algorithm>
#include <map>

#include "core/error.h"
#include "core/neighbours.h"
#include "rig/attachments.h"
#include "rig/feature_points.h"
#include "rig/kmeans.h"
#include "rig/motion_features.h"
#include "rig/patches.h"

namespace vultus::rig {
namespace {

constexpr int kSmoothingRounds = 4;
constexpr int kRefiningRounds = 8;
constexpr double kBorderStiffness = 2.0;
constexpr double kStill = 0.25;          // mm
constexpr double kStillShare = 0.05;     // of the greatest motion
constexpr double kVisibleShare = 0.2;    // of the greatest motion: counts half
constexpr double kSmallestIsland = 0.2;  // of the largest island's vertices

std::vector<const Points*> pose_pointers(const Actor& actor) {
  std::vector<const Points*> poses;
  for (const Pose& pose : actor.poses) poses.push_back(&pose.positions);
  return poses;
}

Adjacency skin_adjacency(const Topology& topology, const std::vector<bool>& used) {
  const Adjacency all = adjacency(topology);
  Adjacency kept;
  kept.offsets.push_back(0);
  for (int v = 0; v < topology.vertex_count(); ++v) {
    for (int neighbour : all.of(v))
      if (used[v] && used[neighbour]) kept.vertices.push_back(neighbour);
    kept.offsets.push_back(static_cast<int>(kept.vertices.size()));
  }
  return kept;
}

/// Drops islands of moving vertices (the inside of a nostril) that are too small to be regions of their own.
void drop_small_islands(const Adjacency& skin, std::vector<bool>& moving) {
  std::vector<int> labels(moving.size());
  for (std::size_t v = 0; v < moving.size(); ++v) labels[v] = moving[v] ? 0 : -1;
  const Patches islands = connected_patches(skin, labels);
  std::vector<int> size(islands.count, 0);
  for (std::size_t v = 0; v < moving.size(); ++v)
    if (moving[v]) ++size[islands.labels[v]];
  const int largest = *std::max_element(size.begin(), size.end());
  for (std::size_t v = 0; v < moving.size(); ++v)
    moving[v] = moving[v] && size[islands.labels[v]] >= kSmallestIsland * largest;
}

/// Where regions may be: what the topology calls face and not hidden. The inside of the mouth moves most of all, but no
/// marker and no camera sees it; it belongs to the region around it.
std::vector<bool> visible_vertices(const Topology& topology, std::vector<bool> skin) {
  if (topology.has_set("face")) {
    std::vector<bool> face(skin.size(), false);
    for (int v : topology.set("face")) face[v] = skin[v];
    skin = std::move(face);
  }
  if (topology.has_set("hidden"))
    for (int v : topology.set("hidden")) skin[v] = false;
  return skin;
}

std::vector<bool> moving_vertices(const MotionField& field, const std::vector<bool>& skin) {
  double greatest = 0.0;
  for (std::size_t v = 0; v < skin.size(); ++v)
    if (skin[v]) greatest = std::max(greatest, field.range[static_cast<Eigen::Index>(v)]);
  // A rig in which everything is subtle is still a rig: half the greatest motion always counts.
  const double threshold = std::min(std::max(kStill, kStillShare * greatest), 0.5 * greatest);
  std::vector<bool> moving(skin.size());
  for (std::size_t v = 0; v < skin.size(); ++v)
    moving[v] = skin[v] && greatest > 0.0 && field.range[static_cast<Eigen::Index>(v)] > threshold;
  if (std::find(moving.begin(), moving.end(), true) == moving.end())
    throw InputError("no vertex of the face moves in any pose, so that there is nothing to segment");
  return moving;
}

/// k-means over the rows of moving vertices; -1 elsewhere. With `mirror`, only the side x ≥ 0 is clustered and its
/// clusters are copied to the other.
std::vector<int> cluster(const Eigen::MatrixXd& rows, const Eigen::VectorXd& weights, const std::vector<bool>& moving,
                         const std::vector<int>& mirror, const Points& rest, int clusters, std::uint64_t seed) {
  const auto on_first_side = [&](int v) { return mirror.empty() || rest(v, 0) >= 0.0 || mirror[v] == v; };
  std::vector<int> vertices;
  for (int v = 0; v < static_cast<int>(moving.size()); ++v)
    if (moving[v] && on_first_side(v)) vertices.push_back(v);
  const auto count = static_cast<Eigen::Index>(vertices.size());
  Eigen::MatrixXd chosen(count, rows.cols());
  Eigen::VectorXd chosen_weights(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    chosen.row(i) = rows.row(vertices[i]);
    chosen_weights[i] = weights[vertices[i]];
  }
  const KMeansResult result = k_means(chosen, chosen_weights, clusters, seed);
  std::vector<int> labels(moving.size(), -1);
  for (Eigen::Index i = 0; i < count; ++i) labels[vertices[i]] = result.labels[static_cast<std::size_t>(i)];
  const int found = static_cast<int>(result.centres.rows());
  for (int v = 0; v < static_cast<int>(moving.size()); ++v)
    if (moving[v] && !on_first_side(v) && labels[mirror[v]] >= 0) labels[v] = found + labels[mirror[v]];
  return labels;
}

/// Makes the side x < 0 the mirror image of the other after borders moved.
void copy_side(const std::vector<int>& mirror, const Points& rest, Patches& patches) {
  std::vector<std::map<int, int>> votes(patches.count);
  for (std::size_t v = 0; v < patches.labels.size(); ++v)
    if (patches.labels[v] >= 0 && patches.labels[mirror[v]] >= 0) ++votes[patches.labels[v]][patches.labels[mirror[v]]];
  const auto fewer = [](const auto& a, const auto& b) { return a.second < b.second; };
  const std::vector<int> old = patches.labels;
  for (int v = 0; v < static_cast<int>(old.size()); ++v) {
    if (old[v] < 0 || rest(v, 0) >= 0.0 || mirror[v] == v || old[mirror[v]] < 0) continue;
    const auto& images = votes[old[mirror[v]]];
    if (!images.empty()) patches.labels[v] = std::max_element(images.begin(), images.end(), fewer)->first;
  }
}

std::vector<int> patch_sizes(const Patches& patches) {
  std::vector<int> sizes(patches.count, 0);
  for (int label : patches.labels)
    if (label >= 0) ++sizes[label];
  return sizes;
}

struct Problem {
  const Actor& actor;
  const SegmentationOptions& options;
  std::vector<const Points*> poses;
  std::vector<bool> skin;
  Adjacency moving_adjacency;
  std::vector<int> mirror;  // empty unless symmetric
  MergeGoal goal;
  const Points& rest() const { return actor.rest.rows() > 0 ? actor.rest : actor.neutral(); }
};

Patches patches_of(const Problem& problem, const Eigen::MatrixXd& rows, const Eigen::VectorXd& weights,
                   const std::vector<bool>& moving, int clusters) {
  const std::vector<int> labels =
      cluster(rows, weights, moving, problem.mirror, problem.rest(), clusters, problem.options.seed);
  Patches patches = connected_patches(problem.moving_adjacency, labels);
  if (patches.count < problem.goal.regions)
    throw InputError("the poses move the skin in only " + std::to_string(patches.count) + " separate ways; " +
                     std::to_string(problem.goal.regions) + " regions cannot be told apart");
  return patches;
}

Patches segment_liu(const Problem& problem, const Segmentation& so_far) {
  const int clusters = problem.options.clusters > 0 ? problem.options.clusters : 8;
  const Eigen::MatrixXd directions = so_far.field.directions;
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(directions.rows());
  Patches patches = patches_of(problem, directions, ones, so_far.moving, clusters);
  merge_fewest_vertices(problem.moving_adjacency, problem.goal, patches);
  return patches;
}

/// Motion that shows counts fully; what barely moves (neck, scalp) must not claim regions. Vertices count alike
/// whatever their area, as in the paper: a modeller puts them where the face works.
Eigen::VectorXd importance(const MotionField& field) {
  const Eigen::ArrayXd relative = (field.range.array() / (kVisibleShare * field.range.maxCoeff())).square();
  return relative / (1.0 + relative);
}

Patches segment_motion(const Problem& problem, const Segmentation& so_far) {
  const int asked = problem.options.clusters;
  const int clusters = asked > 0 ? asked : std::max(64, 4 * problem.goal.regions);
  const registration::Ibug68 points = face_points(*problem.actor.topology, problem.actor.ibug68);
  const Eigen::MatrixXd rows =
      motion_features(problem.poses, so_far.moving, problem.mirror, upper_face_side(problem.actor.neutral(), points));
  const Eigen::VectorXd weights = importance(so_far.field);
  Patches patches = patches_of(problem, rows, weights, so_far.moving, clusters);
  merge_least_variance(problem.moving_adjacency, rows, weights, problem.mirror, problem.goal, patches);
  Patches refined = patches;
  refine_borders(problem.moving_adjacency, problem.actor.neutral(), rows, weights, kBorderStiffness, kRefiningRounds,
                 refined);
  if (!problem.mirror.empty()) copy_side(problem.mirror, problem.rest(), refined);
  // A patch that is all border would vanish, and one merged on one side alone has no image: borders then stay rough.
  const std::vector<int> before = patch_sizes(patches), after = patch_sizes(refined);
  for (int p = 0; p < patches.count; ++p)
    if (2 * after[p] < before[p]) return patches;
  return refined;
}

/// Gives every vertex a region and numbers regions by first vertex.
void label_everything(const Actor& actor, const std::vector<bool>& skin, Patches patches, Segmentation& result) {
  spread_labels(skin_adjacency(*actor.topology, skin), actor.neutral(), patches.labels);
  for (std::size_t v = 0; v < skin.size(); ++v)
    if (!skin[v]) patches.labels[v] = patches.labels[result.follows[v]];
  std::vector<int> number(patches.count, -1);
  for (int& label : patches.labels) {
    if (number[label] < 0) number[label] = result.regions++;
    label = number[label];
  }
  result.labels = std::move(patches.labels);
}

}  // namespace

void SegmentationOptions::validate() const {
  if (regions < 0 || regions > 256) throw InputError("regions must be from 0 to 256");
  if (min_vertices < 0) throw InputError("min_vertices must not be negative");
  if (clusters < 0 || clusters > 4096) throw InputError("clusters must be from 0 to 4096");
}

Segmentation segment(const Actor& actor, const SegmentationOptions& options) {
  options.validate();
  Problem problem{actor, options, pose_pointers(actor), skin_vertices(*actor.topology), {}, {}, {}};
  Segmentation result;
  result.field = motion_field(problem.poses);
  const Adjacency skin = skin_adjacency(*actor.topology, problem.skin);
  result.coordination = coordinate_signs(result.field, skin);
  smooth_directions(result.field, skin, kSmoothingRounds);
  result.moving = moving_vertices(result.field, visible_vertices(*actor.topology, problem.skin));
  drop_small_islands(skin, result.moving);
  result.follows = attachments(*actor.topology, problem.poses, problem.skin);
  problem.moving_adjacency = skin_adjacency(*actor.topology, result.moving);
  const auto moving = static_cast<int>(std::count(result.moving.begin(), result.moving.end(), true));
  const int least = options.regions == 0                           ? moving / 12
                    : options.method == SegmentationMethod::motion ? moving / 100
                                                                   : 0;
  problem.goal = {options.regions, options.min_vertices > 0 ? options.min_vertices : least};
  if (options.symmetric) problem.mirror = mirror_vertices(problem.rest(), result.moving);
  Patches patches =
      options.method == SegmentationMethod::liu ? segment_liu(problem, result) : segment_motion(problem, result);
  label_everything(actor, problem.skin, std::move(patches), result);
  return result;
}

}  // namespace vultus::rig
