#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace vultus::virtual_stage {

/// Eyebrows as single hairs, seen from the front in the template's neutral frame.
class EyebrowPaint {
 public:
  explicit EyebrowPaint(std::uint32_t seed);
  /// Part of the skin that brow hair covers at `p` (neutral, mm), 0 … 1.
  double coverage(const Eigen::Vector3d& p) const;

 private:
  struct Hair {
    Eigen::Vector2d root, tip;
    double width;
  };
  std::vector<Hair> hairs_;
};

/// Part of the scalp that short-cropped hair covers at `p` (neutral, mm), 0 … 1: inside a natural hairline, around the
/// ears, to the nape.
double scalp_coverage(const Eigen::Vector3d& p, std::uint32_t seed);

}  // namespace vultus::virtual_stage
