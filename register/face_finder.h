#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace vultus::registration {

/// 8-bit grey picture, row 0 at the top.
struct GreyImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
};

/// A frontal face in a picture.
struct FoundFace {
  double score = 0.0;                      ///< the detector's margin; above 0 is a face
  std::array<Eigen::Vector2d, 68> points;  ///< pixels, centres at +0.5, 68-point scheme
};

/// dlib's frontal face detector (HOG) and 68-point shape predictor (Kazemi & Sullivan 2014). The model file is for
/// non-commercial use, hence optional.
class FaceFinder {
 public:
  /// The 68-point model: $VULTUS_DLIB_MODEL, else Debian's libdlib-data. Throws `ToolError` saying how to get it.
  static std::filesystem::path find_model();

  explicit FaceFinder(const std::filesystem::path& model = find_model());
  ~FaceFinder();

  /// The best face scoring above `least_score`; needs some 80 pixels across. May run from many threads.
  std::optional<FoundFace> find(const GreyImage& picture, double least_score = 0.0) const;
  /// At most `most` faces, best first.
  std::vector<FoundFace> find_all(const GreyImage& picture, double least_score, int most) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace vultus::registration
