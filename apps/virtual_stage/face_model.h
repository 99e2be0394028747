#pragma once

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "apps/virtual_stage/jaw.h"
#include "apps/virtual_stage/lids.h"
#include "apps/virtual_stage/muscle_fields.h"
#include "register/template.h"

namespace vultus::virtual_stage {

/// A head that can act: one identity on the template subdivided as its registration is, with what each muscle does to
/// it worked out from its own landmarks. Muscles displace; lids turn about the eyeballs; the jaw turns and slides about
/// the condyles; lips that would pass through each other push each other away.
class FaceModel {
 public:
  /// `control` is the identity on `head`'s control mesh (vertex_count×3, mm, face frame); `head` is
  /// `registration::template_head()`.
  FaceModel(const registration::Template& head, const Points& control);

  const std::shared_ptr<const Topology>& topology() const { return topology_; }  ///< subdivided
  const Points& neutral() const { return neutral_; }
  /// Positions (vertex_count×3, mm, face frame) under `activations` (channel_count).
  Points pose(const Activations& activations) const;

  const LidMotion& lids(Side side) const { return lids_[static_cast<int>(side)]; }
  /// (upper, lower) vertices of the subdivided lips that touch while the mouth is closed, right to left.
  const std::vector<std::pair<int, int>>& lip_pairs() const { return lip_pairs_; }

 private:
  void close_lids(Points& positions, const Activations& activations) const;
  void keep_lips_apart(Points& positions) const;

  std::shared_ptr<const Topology> topology_;
  Points neutral_;
  std::vector<MuscleField> fields_;  // one a muscle channel
  std::array<LidMotion, 2> lids_;
  JawMotion jaw_;
  std::vector<std::pair<int, int>> lip_pairs_;

  // How each vertex follows its lip when lips push: share (0 … 1) and place among `lip_pairs_`.
  struct LipFollower {
    int vertex;
    double share, place;
    bool upper;
  };
  std::vector<LipFollower> lip_followers_;
};

}  // namespace vultus::virtual_stage
