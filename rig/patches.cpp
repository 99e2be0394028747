#include "rig/patches.h"

#include <algorithm>
#include <limits>
#include <map>

#include "rig/geodesic.h"
#include "rig/patch_graph.h"

namespace vultus::rig {
namespace {

/// The live patch with the fewest vertices that has neighbours; -1 when none has.
int smallest_patch(const PatchGraph& graph) {
  int best = -1;
  for (int p = 0; p < graph.size(); ++p)
    if (graph.is_alive(p) && !graph.neighbours(p).empty() && (best < 0 || graph.vertices(p) < graph.vertices(best)))
      best = p;
  return best;
}

bool all_large(const PatchGraph& graph, int min_vertices) {
  const int smallest = smallest_patch(graph);
  return smallest < 0 || graph.vertices(smallest) >= min_vertices;
}

bool reached(const PatchGraph& graph, const MergeGoal& goal) {
  return goal.regions > 0 ? graph.alive() <= goal.regions : all_large(graph, goal.min_vertices);
}

/// Patch on the other side of each patch: where most of its vertices' mirror images lie; itself if that is not mutual.
std::vector<int> mirror_patches(const Patches& patches, const std::vector<int>& mirror) {
  std::vector<int> other(patches.count);
  std::vector<std::map<int, int>> votes(patches.count);
  for (std::size_t v = 0; v < patches.labels.size() && !mirror.empty(); ++v)
    if (patches.labels[v] >= 0 && patches.labels[mirror[v]] >= 0) ++votes[patches.labels[v]][patches.labels[mirror[v]]];
  const auto fewer = [](const auto& a, const auto& b) { return a.second < b.second; };
  for (int p = 0; p < patches.count; ++p)
    other[p] = votes[p].empty() ? p : std::max_element(votes[p].begin(), votes[p].end(), fewer)->first;
  for (int p = 0; p < patches.count; ++p)
    if (other[other[p]] != p) other[p] = p;
  return other;
}

/// Groups of patches that are joined when a and b are.
using Merge = std::vector<std::vector<int>>;

Merge merge_of(int a, int b, const std::vector<int>& mirror) {
  const int mirrored_a = mirror[a], mirrored_b = mirror[b];
  if (mirrored_a == b) return {{a, b}};
  std::vector<int> all = {a, b, mirrored_a, mirrored_b};
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  if (all.size() < 4) return {all};
  return {{std::min(a, b), std::max(a, b)}, {std::min(mirrored_a, mirrored_b), std::max(mirrored_a, mirrored_b)}};
}

int patches_removed(const Merge& merge) {
  int removed = 0;
  for (const auto& group : merge) removed += static_cast<int>(group.size()) - 1;
  return removed;
}

/// The merge that costs least for each patch it removes, removing at most `most`; empty when there is none.
Merge cheapest(const PatchGraph& graph, const std::vector<int>& mirror, const std::vector<int>& candidates, int most) {
  Merge best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (int a : candidates)
    for (int b : graph.neighbours(a)) {
      const Merge merge = merge_of(a, b, mirror);
      const int removed = patches_removed(merge);
      if (removed > most) continue;
      double cost = 0.0;
      for (const auto& group : merge) cost += graph.cost(group);
      if (cost / removed >= best_cost) continue;
      best_cost = cost / removed;
      best = merge;
    }
  return best;
}

void apply(const Merge& merge, PatchGraph& graph, std::vector<int>& mirror) {
  for (const auto& group : merge) graph.merge(group);
  const int a = merge.front().front(), b = merge.back().front();
  mirror[a] = b;
  mirror[b] = a;
}

std::vector<int> live_patches(const PatchGraph& graph) {
  std::vector<int> live;
  for (int p = 0; p < graph.size(); ++p)
    if (graph.is_alive(p)) live.push_back(p);
  return live;
}

Eigen::MatrixXd patch_means(const Eigen::MatrixXd& rows, const Eigen::VectorXd& weights, const Patches& patches) {
  Eigen::MatrixXd means = Eigen::MatrixXd::Zero(patches.count, rows.cols());
  Eigen::VectorXd totals = Eigen::VectorXd::Zero(patches.count);
  for (Eigen::Index v = 0; v < rows.rows(); ++v) {
    const int label = patches.labels[static_cast<std::size_t>(v)];
    if (label < 0) continue;
    means.row(label) += weights[v] * rows.row(v);
    totals[label] += weights[v];
  }
  for (int p = 0; p < patches.count; ++p)
    if (totals[p] > 0.0) means.row(p) /= totals[p];
  return means;
}

double mean_spread(const Eigen::MatrixXd& rows, const Eigen::VectorXd& weights, const Eigen::MatrixXd& means,
                   const Patches& patches) {
  double sum = 0.0, total = 0.0;
  for (Eigen::Index v = 0; v < rows.rows(); ++v) {
    const int label = patches.labels[static_cast<std::size_t>(v)];
    if (label < 0) continue;
    sum += weights[v] * (rows.row(v) - means.row(label)).squaredNorm();
    total += weights[v];
  }
  return total > 0.0 && sum > 0.0 ? sum / total : 1.0;
}

int best_label(int v, const Adjacency& adjacency, const Eigen::MatrixXd& rows, const Eigen::MatrixXd& means,
               double spread, double stiffness, const std::vector<int>& labels) {
  int best = labels[v];
  double best_cost = std::numeric_limits<double>::infinity();
  const auto consider = [&](int label) {
    double others = 0.0, all = 0.0;
    for (int neighbour : adjacency.of(v)) {
      if (labels[neighbour] < 0) continue;
      all += 1.0;
      others += labels[neighbour] != label ? 1.0 : 0.0;
    }
    const double cost =
        (rows.row(v) - means.row(label)).squaredNorm() / spread + (all > 0 ? stiffness * others / all : 0);
    if (cost < best_cost) {
      best_cost = cost;
      best = label;
    }
  };
  consider(labels[v]);
  for (int neighbour : adjacency.of(v))
    if (labels[neighbour] >= 0 && labels[neighbour] != labels[v]) consider(labels[neighbour]);
  return best;
}

/// Keeps the largest connected part of each label and lets its neighbours have the rest.
void give_away_fragments(const Adjacency& adjacency, const Points& positions, Patches& patches) {
  const Patches parts = connected_patches(adjacency, patches.labels);
  std::vector<int> size(parts.count, 0), label_of(parts.count, -1), largest(patches.count, -1);
  std::vector<bool> labelled(patches.labels.size());
  for (std::size_t v = 0; v < patches.labels.size(); ++v) {
    labelled[v] = patches.labels[v] >= 0;
    if (!labelled[v]) continue;
    ++size[parts.labels[v]];
    label_of[parts.labels[v]] = patches.labels[v];
  }
  for (int part = 0; part < parts.count; ++part) {
    int& best = largest[label_of[part]];
    if (best < 0 || size[part] > size[best]) best = part;
  }
  std::vector<int> labels(patches.labels.size(), -1);
  for (std::size_t v = 0; v < labels.size(); ++v)
    if (labelled[v] && largest[patches.labels[v]] == parts.labels[v]) labels[v] = patches.labels[v];
  spread_labels(adjacency, positions, labels);
  for (std::size_t v = 0; v < labels.size(); ++v)
    if (labelled[v]) patches.labels[v] = labels[v];
}

}  // namespace

Patches connected_patches(const Adjacency& adjacency, const std::vector<int>& labels) {
  Patches patches{std::vector<int>(labels.size(), -1), 0};
  std::vector<int> open;
  for (int first = 0; first < static_cast<int>(labels.size()); ++first) {
    if (labels[first] < 0 || patches.labels[first] >= 0) continue;
    patches.labels[first] = patches.count;
    open.push_back(first);
    while (!open.empty()) {
      const int v = open.back();
      open.pop_back();
      for (int neighbour : adjacency.of(v)) {
        if (labels[neighbour] != labels[first] || patches.labels[neighbour] >= 0) continue;
        patches.labels[neighbour] = patches.count;
        open.push_back(neighbour);
      }
    }
    ++patches.count;
  }
  return patches;
}

void spread_labels(const Adjacency& adjacency, const Points& positions, std::vector<int>& labels) {
  std::vector<int> sources;
  for (int v = 0; v < static_cast<int>(labels.size()); ++v)
    if (labels[v] >= 0) sources.push_back(v);
  const EdgeDistances nearest = edge_distances(adjacency, positions, sources);
  for (std::size_t v = 0; v < labels.size(); ++v)
    if (labels[v] < 0 && nearest.source[v] >= 0) labels[v] = labels[sources[nearest.source[v]]];
}

void merge_fewest_vertices(const Adjacency& adjacency, const MergeGoal& goal, Patches& patches) {
  const auto count = static_cast<Eigen::Index>(patches.labels.size());
  PatchGraph graph(adjacency, Eigen::MatrixXd(count, 0), Eigen::VectorXd::Ones(count), patches);
  for (int smallest = smallest_patch(graph); smallest >= 0 && !reached(graph, goal); smallest = smallest_patch(graph)) {
    int target = -1;
    for (int neighbour : graph.neighbours(smallest))
      if (target < 0 || graph.vertices(neighbour) < graph.vertices(target)) target = neighbour;
    graph.merge({target, smallest});
  }
  patches = graph.result(patches);
}

void merge_least_variance(const Adjacency& adjacency, const Eigen::MatrixXd& rows, const Eigen::VectorXd& weights,
                          const std::vector<int>& mirror, const MergeGoal& goal, Patches& patches) {
  PatchGraph graph(adjacency, rows, weights, patches);
  std::vector<int> mirrored = mirror_patches(patches, mirror);
  std::vector<int> alone(patches.count);
  for (int p = 0; p < patches.count; ++p) alone[p] = p;
  constexpr int any = std::numeric_limits<int>::max();
  while (!reached(graph, goal)) {
    const bool any_patch = goal.regions > 0 && all_large(graph, goal.min_vertices);
    const std::vector<int> candidates = any_patch ? live_patches(graph) : std::vector<int>{smallest_patch(graph)};
    Merge merge = cheapest(graph, mirrored, candidates, goal.regions > 0 ? graph.alive() - goal.regions : any);
    const bool one_sided = merge.empty();
    if (one_sided) merge = cheapest(graph, alone, candidates, 1);
    if (merge.empty()) break;
    if (one_sided)
      for (int p : merge.front()) mirrored[mirrored[p]] = mirrored[p];
    apply(merge, graph, mirrored);
  }
  patches = graph.result(patches);
}

void refine_borders(const Adjacency& adjacency, const Points& positions, const Eigen::MatrixXd& rows,
                    const Eigen::VectorXd& weights, double stiffness, int rounds, Patches& patches) {
  for (int round = 0; round < rounds; ++round) {
    const Eigen::MatrixXd means = patch_means(rows, weights, patches);
    const double spread = mean_spread(rows, weights, means, patches);
    const std::vector<int> old = patches.labels;
    for (int v = 0; v < static_cast<int>(old.size()); ++v)
      if (old[v] >= 0) patches.labels[v] = best_label(v, adjacency, rows, means, spread, stiffness, old);
    give_away_fragments(adjacency, positions, patches);
  }
}

}  // namespace vultus::rig
