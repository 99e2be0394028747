#include "register/untangle.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <set>

#include "core/corners.h"
#include "register/unfold.h"

namespace vultus::registration {
namespace {

class Untangling {
 public:
  Untangling(const Topology& topology, const Points& reference, const Points& positions, const std::vector<bool>& held)
      : triangles_(topology.triangles()),
        corners_(topology.vertex_count(), {triangles_.data(), static_cast<std::size_t>(triangles_.size())}),
        held_(held),
        excused_(turned_triangles(topology, reference)),
        positions_(positions) {}

  // One visit to each vertex near the folds; false when nothing moved.
  bool pass(const std::vector<bool>& folded) {
    std::set<int> near;
    for (std::size_t t = 0; t < folded.size(); ++t)
      for (int k = 0; folded[t] && k < 3; ++k)
        for (const int v : around(triangles_(static_cast<int>(t), k)))
          if (!held_[v]) near.insert(v);
    bool moved = false;
    for (const int v : near) moved = improve(v) || moved;
    return moved;
  }

  const Points& positions() const { return positions_; }

 private:
  // The vertex and its neighbours.
  std::set<int> around(int v) const {
    std::set<int> ring{v};
    for (const int corner : corners_.at(v))
      for (int k = 0; k < 3; ++k) ring.insert(triangles_(corner / 3, k));
    return ring;
  }

  Eigen::Vector3d area_vector(int t) const {
    const Eigen::Vector3d a = positions_.row(triangles_(t, 0)), b = positions_.row(triangles_(t, 1)),
                          c = positions_.row(triangles_(t, 2));
    return (b - a).cross(c - a);
  }

  // By how much triangles that `v` has a say in fall short of looking clearly the way their corners do.
  double shortfall(int v) const {
    constexpr double clear = 0.25;  // mean cosine: what turns for rounding's sake must not count
    std::set<int> region;
    std::map<int, Eigen::Vector3d> normals;
    for (const int w : around(v))
      for (const int corner : corners_.at(w)) region.insert(corner / 3);
    for (const int t : region)
      for (int k = 0; k < 3; ++k) {
        Eigen::Vector3d& normal = normals.try_emplace(triangles_(t, k), Eigen::Vector3d::Zero()).first->second;
        if (!normal.isZero()) continue;
        const int w = triangles_(t, k);
        for (const int corner : corners_.at(w)) normal += area_vector(corner / 3);
        normal.normalize();
      }
    double sum = 0.0;
    for (const int t : region) {
      if (excused_[t]) continue;
      const Eigen::Vector3d face = area_vector(t).normalized();
      double cosine = 0.0;
      for (int k = 0; k < 3; ++k) cosine += face.dot(normals.at(triangles_(t, k))) / 3.0;
      sum += std::max(0.0, clear - cosine);
    }
    return sum;
  }

  bool improve(int v) {
    const Eigen::RowVector3d from = positions_.row(v);
    Eigen::RowVector3d mean = Eigen::RowVector3d::Zero(), best = from;
    const std::set<int> ring = around(v);
    for (const int w : ring)
      if (w != v) mean += positions_.row(w) / static_cast<double>(ring.size() - 1);
    double least = shortfall(v) - 1e-6;
    for (const double share : {0.25, 0.5, 1.0}) {
      positions_.row(v) = from + share * (mean - from);
      const double now = shortfall(v);
      if (now >= least) continue;
      least = now;
      best = positions_.row(v);
    }
    positions_.row(v) = best;
    return best != from;
  }

  const Triangles& triangles_;
  const Corners corners_;
  const std::vector<bool>& held_;
  std::vector<bool> excused_;  // turned in the reference already
  Points positions_;
};

}  // namespace

Points untangled(const Topology& topology, const Points& reference, const Points& positions,
                 const std::vector<bool>& held) {
  Untangling untangling(topology, reference, positions, held);
  constexpr int passes = 12;
  for (int pass = 0; pass < passes; ++pass) {
    const std::vector<bool> folded = folded_triangles(topology, reference, untangling.positions());
    if (std::find(folded.begin(), folded.end(), true) == folded.end() || !untangling.pass(folded)) break;
  }
  return untangling.positions();
}

}  // namespace vultus::registration
