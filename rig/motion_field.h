#pragma once

#include <span>

#include "core/mesh.h"
#include "core/neighbours.h"

namespace vultus::rig {

/// How the vertices of a blendshape rig move (Liu et al. 2011 §3.2.1): PCA of each vertex over all poses.
struct MotionField {
  Points directions;          ///< n×3, unit first principal component; zero for a vertex that never moves
  Eigen::VectorXd deviation;  ///< n, standard deviation along it, mm
  Eigen::VectorXd certainty;  ///< n, in [0, 1]: 1 − λ₂/λ₁; 0 where no direction is preferred
  Eigen::VectorXd range;      ///< n, greatest distance of any pose from the first, mm
};

/// `poses` are shapes on one topology, n×3 mm; at least two. The signs of the directions are arbitrary (Liu figure 1a).
MotionField motion_field(std::span<const Points* const> poses);

struct Coordination {
  double initial_energy = 0.0, final_energy = 0.0;  ///< −Σ over edges of dᵢ·dⱼ
  int sweeps = 0;                                   ///< of the descent; its limit was not reached
};

/// Chooses the sign of each direction so that neighbours agree (Liu figure 1b): minimises E = −Σ dᵢ·dⱼ over the edges.
/// (The paper says "minimizing the sum of dot products"; the sum that makes neighbours alike is that of their
/// negatives.) Signs on a graph are an Ising problem: the start is exact on the maximum spanning forest of |dᵢ·dⱼ|,
/// which settles every edge that could be settled without contradiction, strongest first; then single vertices flip
/// while that lowers E. Each connected part finally points up on average.
Coordination coordinate_signs(MotionField& field, const Adjacency& adjacency);

/// Lets uncertain directions follow certain neighbours: `rounds` of averaging the own direction, weighted by certainty,
/// with those of the neighbours, weighted by certainty and deviation. Signs must agree already.
void smooth_directions(MotionField& field, const Adjacency& adjacency, int rounds);

}  // namespace vultus::rig
