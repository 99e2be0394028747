#include "rig/attachments.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "core/error.h"
#include "core/neighbours.h"
#include "core/transform.h"

namespace vultus::rig {
namespace {

constexpr int kNearestFew = 24;
constexpr double kRigidResidual = 0.2;  // mm; well above float32 files, well below any bending that shows
constexpr double kStill = 0.05;         // mm

Points rows_of(const Points& all, const std::vector<int>& chosen) {
  Points some(static_cast<Eigen::Index>(chosen.size()), 3);
  for (std::size_t i = 0; i < chosen.size(); ++i) some.row(static_cast<Eigen::Index>(i)) = all.row(chosen[i]);
  return some;
}

bool moves_rigidly(const std::vector<int>& part, std::span<const Points* const> poses) {
  if (part.size() < 4) return false;
  const Points rest = rows_of(*poses[0], part);
  for (const Points* pose : poses.subspan(1)) {
    const Points moved = rows_of(*pose, part);
    try {
      const Points fitted = transformed(fit_similarity(rest, moved, Scaling::fixed), rest);
      if ((fitted - moved).rowwise().norm().maxCoeff() > kRigidResidual) return false;
    } catch (const InputError&) {
      return false;  // collinear vertices have no orientation to follow
    }
  }
  return true;
}

/// Σ over poses of the squared difference between a displacement and that of a skin vertex.
double unlikeness(const Points& motion, int skin_vertex, std::span<const Points* const> poses) {
  double sum = 0.0;
  for (std::size_t p = 1; p < poses.size(); ++p)
    sum += (motion.row(static_cast<Eigen::Index>(p)) - poses[p]->row(skin_vertex) + poses[0]->row(skin_vertex))
               .squaredNorm();
  return sum;
}

Points mean_motion(const std::vector<int>& part, std::span<const Points* const> poses) {
  Points motion = Points::Zero(static_cast<Eigen::Index>(poses.size()), 3);
  for (std::size_t p = 1; p < poses.size(); ++p)
    for (int v : part)
      motion.row(static_cast<Eigen::Index>(p)) +=
          (poses[p]->row(v) - poses[0]->row(v)) / static_cast<double>(part.size());
  return motion;
}

int most_alike(const Points& motion, const std::vector<int>& candidates, std::span<const Points* const> poses) {
  int best = candidates.front();
  double best_unlikeness = std::numeric_limits<double>::infinity();
  for (int v : candidates) {
    const double difference = unlikeness(motion, v, poses);
    if (difference >= best_unlikeness) continue;
    best_unlikeness = difference;
    best = v;
  }
  return best;
}

class SkinTree {
 public:
  SkinTree(const Points& neutral, const std::vector<bool>& skin)
      : vertices_(chosen(skin)), tree_(rows_of(neutral, vertices_)) {}
  const std::vector<int>& vertices() const { return vertices_; }
  std::vector<int> nearest(const Eigen::Vector3d& place, int count) const {
    std::vector<int> found;
    for (const auto& neighbour : tree_.nearest(place, count)) found.push_back(vertices_[neighbour.index]);
    return found;
  }

 private:
  static std::vector<int> chosen(const std::vector<bool>& skin) {
    std::vector<int> vertices;
    for (int v = 0; v < static_cast<int>(skin.size()); ++v)
      if (skin[v]) vertices.push_back(v);
    return vertices;
  }
  std::vector<int> vertices_;
  PointTree tree_;
};

void attach_part(const std::vector<int>& part, std::span<const Points* const> poses, const SkinTree& skin,
                 std::vector<int>& follows) {
  const Points motion = mean_motion(part, poses);
  if (moves_rigidly(part, poses)) {
    const bool still = motion.rowwise().norm().maxCoeff() < kStill;
    const Eigen::Vector3d middle = rows_of(*poses[0], part).colwise().mean().transpose();
    const int leader = still ? skin.nearest(middle, 1).front() : most_alike(motion, skin.vertices(), poses);
    for (int v : part) follows[v] = leader;
    return;
  }
  for (int v : part)
    follows[v] = most_alike(mean_motion({v}, poses), skin.nearest(poses[0]->row(v).transpose(), kNearestFew), poses);
}

}  // namespace

std::vector<bool> skin_vertices(const Topology& topology) {
  const std::vector<int> part = components(topology);
  std::vector<int> size;
  for (int p : part) {
    if (p >= static_cast<int>(size.size())) size.resize(p + 1, 0);
    ++size[p];
  }
  const auto largest = static_cast<int>(std::max_element(size.begin(), size.end()) - size.begin());
  std::vector<bool> skin(part.size());
  for (std::size_t v = 0; v < part.size(); ++v) skin[v] = part[v] == largest;
  return skin;
}

std::vector<int> attachments(const Topology& topology, std::span<const Points* const> poses,
                             const std::vector<bool>& skin) {
  const std::vector<int> part_of = components(topology);
  std::vector<std::vector<int>> parts;
  for (int v = 0; v < static_cast<int>(part_of.size()); ++v) {
    if (skin[v]) continue;
    if (part_of[v] >= static_cast<int>(parts.size())) parts.resize(part_of[v] + 1);
    parts[part_of[v]].push_back(v);
  }
  std::vector<int> follows(part_of.size(), -1);
  const SkinTree tree(*poses[0], skin);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t p) {
    if (!parts[p].empty()) attach_part(parts[p], poses, tree, follows);
  });
  return follows;
}

}  // namespace vultus::rig
