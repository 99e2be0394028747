#include "register/untangle.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <set>

#include "register/unfold.h"

namespace vultus::registration {
namespace {

// Triangles of each vertex: those of v at [offsets[v], offsets[v+1]).
struct Fans {
  std::vector<int> offsets, triangles;

  explicit Fans(const Topology& topology) : offsets(topology.vertex_count() + 1, 0) {
    const Triangles& all = topology.triangles();
    for (int t = 0; t < all.rows(); ++t)
      for (int k = 0; k < 3; ++k) ++offsets[all(t, k) + 1];
    for (std::size_t v = 1; v < offsets.size(); ++v) offsets[v] += offsets[v - 1];
    std::vector<int> next(offsets.begin(), offsets.end() - 1);
    triangles.resize(offsets.back());
    for (int t = 0; t < all.rows(); ++t)
      for (int k = 0; k < 3; ++k) triangles[next[all(t, k)]++] = t;
  }
};

class Untangling {
 public:
  Untangling(const Topology& topology, const Points& reference, const Points& positions, const std::vector<bool>& held)
      : triangles_(topology.triangles()), fans_(topology), held_(held), positions_(positions) {
    const Points faces = triangle_normals(topology, reference), corners = vertex_normals(topology, reference);
    excused_.resize(faces.rows());
    for (int t = 0; t < faces.rows(); ++t) {
      const auto c = triangles_.row(t);
      excused_[t] = faces.row(t).dot(corners.row(c[0]) + corners.row(c[1]) + corners.row(c[2])) < 0.0;
    }
  }

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
    for (int i = fans_.offsets[v]; i < fans_.offsets[v + 1]; ++i)
      for (int k = 0; k < 3; ++k) ring.insert(triangles_(fans_.triangles[i], k));
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
      region.insert(fans_.triangles.begin() + fans_.offsets[w], fans_.triangles.begin() + fans_.offsets[w + 1]);
    for (const int t : region)
      for (int k = 0; k < 3; ++k) {
        Eigen::Vector3d& normal = normals.try_emplace(triangles_(t, k), Eigen::Vector3d::Zero()).first->second;
        if (!normal.isZero()) continue;
        const int w = triangles_(t, k);
        for (int i = fans_.offsets[w]; i < fans_.offsets[w + 1]; ++i) normal += area_vector(fans_.triangles[i]);
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
  const Fans fans_;
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
