#pragma once

#include <cstdint>

#include "apps/virtual_stage/detail.h"
#include "apps/virtual_stage/scanner.h"
#include "core/image.h"

namespace vultus::virtual_stage {

/// One person: a build, a skin, and how they move.
class VirtualActor {
 public:
  VirtualActor(const registration::Template& head, std::uint64_t seed);

  const FaceModel& face() const { return face_; }
  const registration::Template& head() const { return head_; }
  std::uint64_t seed() const { return seed_; }

 private:
  registration::Template head_;
  std::uint64_t seed_;
  FaceModel face_;
};

/// An actor in front of cameras and scanners: the fine surface, its colour and its hair.
class VisibleActor {
 public:
  explicit VisibleActor(const VirtualActor& actor);

  const std::shared_ptr<const Topology>& topology() const { return detailed_.topology(); }
  Points pose(const Activations& activations) const { return detailed_.pose(activations); }
  ScanSubject subject(const Activations& activations) const;
  const Image& albedo() const { return albedo_; }  ///< texture space of the template, linear RGB

 private:
  DetailedFace detailed_;
  Image albedo_;
  Points colours_;
  Eigen::VectorXd hair_;
};

}  // namespace vultus::virtual_stage
