#include "rig/motion_transfer.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/error.h"
#include "core/files.h"
#include "core/transform.h"
#include "rig/deformation_transfer.h"
#include "rig/feature_points.h"
#include "rig/resample.h"

namespace vultus::rig {
namespace {

// Anchor strengths 1/mm²: a still vertex yields to the gradients within about 2 mm of it, a moving one within 7 mm.
constexpr double kHoldStill = 0.25;
constexpr double kHoldMoving = 0.02;
constexpr double kStill = 0.02;  // mm

bool same_connectivity(const Topology& a, const Topology& b) {
  return a.vertex_count() == b.vertex_count() && a.data().face_offsets == b.data().face_offsets &&
         a.data().corner_vertex == b.data().corner_vertex;
}

/// The source in the target's topology.
struct WorkingSource {
  Points neutral;
  std::optional<Correspondence> correspondence;
};

}  // namespace

TransferMethod transfer_method_named(const std::string& name) {
  if (name == "gradient") return TransferMethod::gradient;
  if (name == "zhu") return TransferMethod::zhu;
  const std::string nearest = nearest_name(name, {"gradient", "zhu"});
  throw UsageError("unknown transfer method \"" + name + "\"; known are gradient and zhu" +
                   (nearest.empty() ? std::string() : "; did you mean \"" + nearest + "\"?"));
}

void TransferOptions::validate() const {
  if (!(scale >= 0.0) || scale > 100.0) throw InputError("transfer scale must be from 0 (automatic) to 100");
  if (!(contact_mm >= 0.0) || contact_mm > 10.0) throw InputError("contact distance must be from 0 to 10 mm");
  if (!(search_mm > 0.0) || search_mm > 200.0) throw InputError("search distance must be above 0 and at most 200 mm");
  if (smoothing_rounds < 0 || smoothing_rounds > 100) throw InputError("smoothing rounds must be from 0 to 100");
}

struct MotionTransfer::Impl {
  std::shared_ptr<const Topology> topology, source_topology;
  Points target, source_neutral;
  TransferOptions options;
  WorkingSource source;
  std::optional<TransferScale> scales;
  double scale = 1.0;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  // target from source
  std::optional<DeformationTransfer> gradients;
  std::vector<std::pair<int, int>> touching;  // in the source's neutral

  Points motion(const Points& source_pose) const {
    const Points moved = source_pose - source_neutral;
    if (!source.correspondence) return moved;
    return resample_motion(*topology, *source.correspondence, *source_topology, moved, options.smoothing_rounds);
  }

  /// Surfaces that touch in the source's neutral keep their motion against each other; those that the pose brings
  /// together come together.
  std::vector<OffsetConstraint> contact_offsets(const Points& pose, const Points& scaled) const {
    std::vector<OffsetConstraint> offsets;
    for (const auto& [a, b] : contacts(*topology, pose, options.contact_mm)) {
      const bool always = std::binary_search(touching.begin(), touching.end(), std::pair(a, b));
      const Eigen::RowVector3d apart = scale * (pose.row(a) - pose.row(b)) * rotation.transpose();
      offsets.push_back({a, b, always ? target.row(a) - target.row(b) + scaled.row(a) - scaled.row(b) : apart});
    }
    return offsets;
  }

  Points by_gradient(const Points& moved) const {
    const Points scaled = scale * moved * rotation.transpose();
    const Eigen::VectorXd strength = (moved.rowwise().norm().array() < kStill)
                                         .select(Eigen::VectorXd::Constant(moved.rows(), kHoldStill),
                                                 Eigen::VectorXd::Constant(moved.rows(), kHoldMoving));
    const Points pose = source.neutral + moved;
    return gradients->solve(pose, rotation, target + scaled, strength, contact_offsets(pose, scaled));
  }
};

MotionTransfer::MotionTransfer(const TransferFace& source, const TransferFace& target, const TransferOptions& options)
    : impl_(std::make_unique<Impl>()) {
  options.validate();
  impl_->topology = target.topology;
  impl_->source_topology = source.topology;
  impl_->target = target.neutral;
  impl_->source_neutral = source.neutral;
  impl_->options = options;
  const registration::Ibug68 source_points = face_points(*source.topology, source.ibug68);
  const registration::Ibug68 target_points = face_points(*target.topology, target.ibug68);
  if (same_connectivity(*source.topology, *target.topology)) {
    impl_->source.neutral = source.neutral;
  } else {
    Correspondence found = correspond(*target.topology, target.neutral, target_points, *source.topology, source.neutral,
                                      source_points, options.search_mm);
    // The deformed mesh is smooth where places on the other surface fold over each other (inside of the lips).
    impl_->source.neutral = found.deformed;
    impl_->source.correspondence = std::move(found);
  }
  if (options.scale > 0.0) {
    impl_->scale = options.scale;
  } else {
    impl_->scales = transfer_scale(source.neutral, source_points, target.neutral, target_points);
    impl_->scale = impl_->scales->mean();
  }
  impl_->rotation =
      fit_similarity_robust(impl_->source.neutral, target.neutral, Scaling::free).target_from_source.rotation;
  if (options.method != TransferMethod::gradient) return;
  impl_->gradients.emplace(*target.topology, impl_->source.neutral, target.neutral);
  impl_->touching = contacts(*target.topology, impl_->source.neutral, options.contact_mm);
}

MotionTransfer::~MotionTransfer() = default;
MotionTransfer::MotionTransfer(MotionTransfer&&) noexcept = default;

Points MotionTransfer::operator()(const Points& source_pose) const {
  if (source_pose.rows() != impl_->source_neutral.rows())
    throw InputError("motion transfer: the pose has " + std::to_string(source_pose.rows()) +
                     " vertices, its neutral has " + std::to_string(impl_->source_neutral.rows()));
  const Points moved = impl_->motion(source_pose);
  if (impl_->gradients) return impl_->by_gradient(moved);
  return impl_->target + impl_->scale * moved * impl_->rotation.transpose();
}

bool MotionTransfer::same_topology() const { return !impl_->source.correspondence; }
double MotionTransfer::scale() const { return impl_->scale; }
const std::optional<TransferScale>& MotionTransfer::scales() const { return impl_->scales; }
double MotionTransfer::found_share() const {
  return impl_->source.correspondence ? impl_->source.correspondence->found_share : 1.0;
}

std::vector<Pose> transfer_poses(const Actor& databank, const TransferFace& target, const TransferOptions& options) {
  const MotionTransfer transfer({databank.topology, databank.neutral(), databank.ibug68}, target, options);
  std::vector<Pose> poses(databank.poses.begin() + 1, databank.poses.end());
  tbb::parallel_for(std::size_t{0}, poses.size(),
                    [&](std::size_t i) { poses[i].positions = transfer(poses[i].positions); });
  return poses;
}

}  // namespace vultus::rig
