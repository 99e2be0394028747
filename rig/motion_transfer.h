#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "register/template.h"
#include "rig/actor.h"
#include "rig/transfer_scale.h"

namespace vultus::rig {

enum class TransferMethod {
  gradient,  ///< how the source deforms, triangle by triangle (Sumner and Popović 2004), contacts kept
  zhu,       ///< scaled motion vectors (Zhu 2006 chapter 5)
};
/// "gradient" or "zhu"; throws `UsageError` with the nearest name.
TransferMethod transfer_method_named(const std::string& name);

struct TransferOptions {
  TransferMethod method = TransferMethod::gradient;
  double scale = 0.0;        ///< of motion, target / source; 0: by `transfer_scale`
  double contact_mm = 0.6;   ///< gradient: surfaces this near face to face touch (lips, lids); 0 ignores contact
  double search_mm = 15.0;   ///< other topology: how far along its normal a vertex looks for the source's surface
  int smoothing_rounds = 1;  ///< other topology: one-ring averages of the motion (Zhu §5.2)
  void validate() const;     ///< throws `InputError`
};

/// A neutral face that motion comes from or goes to.
struct TransferFace {
  std::shared_ptr<const Topology> topology;
  Points neutral;                              ///< vertex_count×3, mm, face frame
  std::optional<registration::Ibug68> ibug68;  ///< completed from MPEG-4 landmarks of the topology
};

/// Brings facial motion from one person's neutral to another's.
///
/// Same topology (Zhu §5.1): motion vectors V = SA − SN (eq. 5.1), times the scale S (eq. 5.2), turned by the rotation
/// between both neutrals, are added to the target's neutral (`zhu`); or the target takes each triangle's deformation
/// gradient from the source, which turns and stretches motion with the local shape (`gradient`): a sparse Poisson
/// system with the target's cotangent weights, held by the scaled vectors where nothing moves and, weakly, elsewhere.
/// Where the source's pose brings two surfaces together, the target's are brought together too.
///
/// Other topology (Zhu §5.2): the target's neutral is deformed to the source's by RBF (Hardy multiquadrics) between the
/// landmarks both have, then each vertex looks along its normal, both ways, for the source's surface; the motion there,
/// interpolated by barycentric coordinates, is its motion. Vertices that find none (back of the head, what the source
/// lacks) take the smoothest continuation. The motion is averaged over one-rings, and is then that of a source with the
/// target's topology. (The thesis re-samples onto a low-resolution generic model and registers the moved source again;
/// here the working model has the target's resolution already.)
class MotionTransfer {
 public:
  /// Throws `InputError` when the faces share too few landmarks.
  MotionTransfer(const TransferFace& source, const TransferFace& target, const TransferOptions& options = {});
  ~MotionTransfer();
  MotionTransfer(MotionTransfer&&) noexcept;

  /// The target in the source's pose, target vertex_count×3, mm. Const and safe from many threads.
  Points operator()(const Points& source_pose) const;

  bool same_topology() const;
  double scale() const;
  const std::optional<TransferScale>& scales() const;  ///< absent when the scale was given
  /// Share of the target's vertices that found the source's surface; 1 with the same topology.
  double found_share() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// All poses of a databank but its neutral, brought to a neutral face; names and tags are kept.
std::vector<Pose> transfer_poses(const Actor& databank, const TransferFace& target,
                                 const TransferOptions& options = {});

}  // namespace vultus::rig
