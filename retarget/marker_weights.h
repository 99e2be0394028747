#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "rig/actor.h"

namespace vultus::retarget {

/// How much each marker counts in each region: the diagonals of Liu's M_k (Liu et al. 2011 §3.2.2).
struct MarkerWeights {
  std::vector<std::string> labels;
  std::vector<std::string> regions;
  Eigen::MatrixXd values;            ///< markers × regions, ≥ 0, rows sum to one
  std::vector<std::string> notes;    ///< markers whose cell held no texel

  /// One region "whole" in which every marker counts fully: the global solve of Liu eq. 1.
  static MarkerWeights global(std::vector<std::string> labels);
};

struct CellOptions {
  int size = 512;                  ///< texels a side of the map the cells are taken on when the actor has no masks; ≥ 16
  std::string face_set = "face";   ///< cells end at the border of this vertex set (where the topology has it)
};

/// r(B_k, q): the mean of region k's mask over marker q's Voronoi cell in texture space, normalized over the regions.
/// A texel belongs to the nearest marker of its own UV chart (ties by the order of labels); cells end at the face's
/// border, so that a marker at the hair line does not speak for the back of the head. A marker whose cell holds no
/// texel takes the masks at its own place. An actor without regions gives `global`. Throws `InputError` for a topology
/// without UVs or a place outside it.
MarkerWeights marker_weights(const rig::Actor& actor, const std::vector<std::string>& labels,
                             const std::vector<SurfacePoint>& places, const CellOptions& options = {});

}  // namespace vultus::retarget
