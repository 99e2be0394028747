#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mesh.h"
#include "core/neighbours.h"

namespace vultus::rig {

/// A division of some vertices into connected patches. Vertices outside have label -1.
struct Patches {
  std::vector<int> labels;  ///< vertex_count
  int count = 0;
};

/// Splits every label into its connected parts, numbered by first vertex.
Patches connected_patches(const Adjacency& adjacency, const std::vector<int>& labels);

/// Gives vertices of label -1 the label of the nearest labelled vertex along edges, where a way leads to one.
void spread_labels(const Adjacency& adjacency, const Points& positions, std::vector<int>& labels);

/// When merging stops: at `regions` patches, or, if that is 0, when every patch has `min_vertices`. With both, patches
/// below `min_vertices` are merged first. A division of several islands keeps at least one patch an island.
struct MergeGoal {
  int regions = 0;
  int min_vertices = 0;
};

/// Liu et al. 2011 §3.2.1: the patch with the fewest vertices is merged into its adjacent patch with the fewest
/// vertices, again and again.
void merge_fewest_vertices(const Adjacency& adjacency, const MergeGoal& goal, Patches& patches);

/// Ward 1963 over the patch graph: merges the two adjacent patches whose union adds least to Σ weight · |row − mean|²;
/// for `min_vertices`, the patch with the fewest vertices goes to the neighbour where it adds least. With `mirror`
/// (vertex → mirrored vertex; empty: none) a merge is done on both sides at once, so that a symmetric division stays
/// symmetric; only if the asked number cannot be reached so, the last merge is done on one side.
void merge_least_variance(const Adjacency& adjacency, const Eigen::MatrixXd& rows, const Eigen::VectorXd& weights,
                          const std::vector<int>& mirror, const MergeGoal& goal, Patches& patches);

/// Straightens borders: `rounds` times, each vertex at a border takes the label that agrees best with its row and its
/// neighbours, Σ over patches of |row − mean|² / spread + stiffness · (share of neighbours with another label). What
/// this cuts off goes to the patch around it.
void refine_borders(const Adjacency& adjacency, const Points& positions, const Eigen::MatrixXd& rows,
                    const Eigen::VectorXd& weights, double stiffness, int rounds, Patches& patches);

}  // namespace vultus::rig
