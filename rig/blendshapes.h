#pragma once

#include <span>
#include <string>
#include <vector>

#include "rig/actor.h"

namespace vultus::rig {

using FloatPoints = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;  ///< n×3, mm

/// An actor's poses laid out for fast blending by region: Σ_k B_k S̄ w_k (Liu et al. 2011 eq. 3). Positions are kept as
/// float displacements from the first pose, without the blocks of vertices that a pose does not move. Results do not
/// depend on the number of threads. Const use from many threads is fine.
class Blendshapes {
 public:
  /// Poses and regions in the order of the weights; no regions stands for one that covers everything. Throws
  /// `InputError` for a name the actor lacks, with the nearest.
  Blendshapes(const Actor& actor, const std::vector<std::string>& poses, const std::vector<std::string>& regions = {});

  int vertices() const { return vertices_; }
  int poses() const { return static_cast<int>(pose_count_); }
  int regions() const { return static_cast<int>(region_count_); }

  /// `weights`: regions × poses, rows one after another; need not sum to one. Throws `InputError` for another size.
  FloatPoints operator()(std::span<const float> weights) const;
  /// The same into `positions`, vertices × 3.
  void blend(std::span<const float> weights, std::span<float> positions) const;

  static constexpr int block = 256;  ///< vertices blended at once

 private:
  struct Shift {  // one pose's displacements of one block: x, y, z planes of `block` floats
    int pose;
    std::size_t offset;
  };
  struct Mask {  // one region's mask over one block
    int region;
    std::size_t offset;
  };
  void blend_block(int number, std::span<const float> weights, std::span<float> positions) const;

  int vertices_ = 0;
  std::size_t pose_count_ = 0, region_count_ = 0;
  std::vector<float> rest_;  // blocks × 3 planes
  std::vector<float> shifts_, masks_;
  std::vector<std::vector<Shift>> block_shifts_;
  std::vector<std::vector<Mask>> block_masks_;
};

}  // namespace vultus::rig
