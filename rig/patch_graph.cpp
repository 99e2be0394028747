#include "rig/patch_graph.h"

#include <numeric>

namespace vultus::rig {

PatchGraph::PatchGraph(const Adjacency& adjacency, const Eigen::MatrixXd& rows, const Eigen::VectorXd& weights,
                       const Patches& patches)
    : neighbours_(patches.count),
      vertices_(patches.count, 0),
      into_(patches.count),
      weights_(patches.count, 0.0),
      means_(Eigen::MatrixXd::Zero(rows.cols(), patches.count)),
      alive_(patches.count) {
  std::iota(into_.begin(), into_.end(), 0);
  for (int v = 0; v < static_cast<int>(patches.labels.size()); ++v) {
    const int label = patches.labels[v];
    if (label < 0) continue;
    ++vertices_[label];
    weights_[label] += weights[v];
    means_.col(label) += weights[v] * rows.row(v).transpose();
    for (int neighbour : adjacency.of(v))
      if (patches.labels[neighbour] >= 0 && patches.labels[neighbour] != label)
        neighbours_[label].insert(patches.labels[neighbour]);
  }
  for (int p = 0; p < patches.count; ++p)
    if (weights_[p] > 0.0) means_.col(p) /= weights_[p];
}

int PatchGraph::find(int patch) const {
  while (into_[patch] != patch) patch = into_[patch];
  return patch;
}

double PatchGraph::cost(const std::vector<int>& patches) const {
  double total = 0.0;
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(means_.rows());
  for (int p : patches) {
    total += weights_[p];
    mean += weights_[p] * means_.col(p);
  }
  if (!(total > 0.0)) return 0.0;
  mean /= total;
  double added = 0.0;
  for (int p : patches) added += weights_[p] * (means_.col(p) - mean).squaredNorm();
  return added;
}

void PatchGraph::merge(const std::vector<int>& patches) {
  const int first = patches.front();
  for (std::size_t i = 1; i < patches.size(); ++i) {
    const int other = patches[i];
    const double total = weights_[first] + weights_[other];
    if (total > 0.0)
      means_.col(first) = (weights_[first] * means_.col(first) + weights_[other] * means_.col(other)) / total;
    weights_[first] = total;
    vertices_[first] += vertices_[other];
    into_[other] = first;
    --alive_;
    for (int neighbour : neighbours_[other]) {
      neighbours_[neighbour].erase(other);
      if (neighbour == first) continue;
      neighbours_[neighbour].insert(first);
      neighbours_[first].insert(neighbour);
    }
    neighbours_[first].erase(other);
    neighbours_[other].clear();
  }
}

Patches PatchGraph::result(const Patches& original) const {
  Patches merged{original.labels, 0};
  std::vector<int> number(vertices_.size(), -1);
  for (int& label : merged.labels) {
    if (label < 0) continue;
    int& own = number[find(label)];
    if (own < 0) own = merged.count++;
    label = own;
  }
  return merged;
}

}  // namespace vultus::rig
