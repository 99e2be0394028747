#pragma once

#include <Eigen/Core>
#include <set>
#include <vector>

#include "rig/patches.h"

namespace vultus::rig {

/// Patches as nodes with their sizes and mean rows, joined where they touch; for the merging of patches.h.
class PatchGraph {
 public:
  /// `rows` may have 0 columns where only sizes matter.
  PatchGraph(const Adjacency& adjacency, const Eigen::MatrixXd& rows, const Eigen::VectorXd& weights,
             const Patches& patches);

  int size() const { return static_cast<int>(vertices_.size()); }
  int alive() const { return alive_; }
  bool is_alive(int patch) const { return into_[patch] == patch; }
  int vertices(int patch) const { return vertices_[patch]; }
  const std::set<int>& neighbours(int patch) const { return neighbours_[patch]; }
  /// The patch that a patch was merged into, or itself.
  int find(int patch) const;

  /// What joining these patches adds to Σ weight · |row − mean|².
  double cost(const std::vector<int>& patches) const;
  /// Joins them all into the first.
  void merge(const std::vector<int>& patches);

  /// The surviving patches, numbered by first vertex.
  Patches result(const Patches& original) const;

 private:
  std::vector<std::set<int>> neighbours_;
  std::vector<int> vertices_, into_;
  std::vector<double> weights_;
  Eigen::MatrixXd means_;  // dimensions × patches
  int alive_ = 0;
};

}  // namespace vultus::rig
