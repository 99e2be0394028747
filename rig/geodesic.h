#pragma once

#include <span>
#include <vector>

#include "core/mesh.h"
#include "core/neighbours.h"

namespace vultus::rig {

/// Shortest ways along polygon edges (Dijkstra 1959), a stand-in for surface distance that any mesh allows.
struct EdgeDistances {
  std::vector<double> distance;  ///< vertex_count, mm; infinite where no way leads
  std::vector<int> source;       ///< vertex_count: which entry of `sources` is nearest; -1 where none
  std::vector<int> previous;     ///< vertex_count: next vertex on the way back; -1 at sources
};

/// From each vertex to the nearest of `sources`, over vertices with `allowed` (empty: all). Ties go to the source that
/// stands first.
EdgeDistances edge_distances(const Adjacency& adjacency, const Points& positions, std::span<const int> sources,
                             const std::vector<bool>& allowed = {});

/// Vertices of the closed line through `ring` in order, each part a shortest way over allowed vertices; sorted. Throws
/// `InputError` when two neighbours of the ring are not connected.
std::vector<int> closed_contour(const Adjacency& adjacency, const Points& positions, std::span<const int> ring,
                                const std::vector<bool>& allowed = {});

/// Vertices reached from `seeds` over allowed vertices without crossing `contour`, with the contour; sorted.
std::vector<int> inside_contour(const Adjacency& adjacency, std::span<const int> contour, std::span<const int> seeds,
                                const std::vector<bool>& allowed = {});

}  // namespace vultus::rig
