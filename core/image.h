#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace vultus {

/// Linear-light float image, row 0 at the top, channels interleaved, pixel centres at +0.5.
class Image {
 public:
  Image() = default;
  /// Zero-filled; `channel_names` such as {"R","G","B"}.
  Image(int width, int height, std::vector<std::string> channel_names);
  static Image rgb(int width, int height) { return Image(width, height, {"R", "G", "B"}); }

  int width() const { return width_; }
  int height() const { return height_; }
  int channels() const { return static_cast<int>(channel_names_.size()); }
  const std::vector<std::string>& channel_names() const { return channel_names_; }
  bool empty() const { return pixels_.empty(); }

  float* at(int x, int y) { return pixels_.data() + (static_cast<std::size_t>(y) * width_ + x) * channel_names_.size(); }
  const float* at(int x, int y) const { return const_cast<Image*>(this)->at(x, y); }
  Eigen::Vector3f rgb_at(int x, int y) const;  ///< first three channels (a single channel is repeated)
  void set_rgb(int x, int y, const Eigen::Vector3f& value);
  std::vector<float>& pixels() { return pixels_; }
  const std::vector<float>& pixels() const { return pixels_; }

  /// Bilinear look-up at continuous pixel coordinates (centres at +0.5), edge clamped.
  float sample(double x, double y, int channel) const;

 private:
  int width_ = 0, height_ = 0;
  std::vector<std::string> channel_names_;
  std::vector<float> pixels_;
};

/// Reads any image OpenImageIO knows, as linear light: 8-bit sRGB files are decoded, EXR/HDR are taken as linear.
/// Data maps (normals, masks, displacement) in 8-bit files are read without decoding with `Encoding::raw`.
/// Channels keep the file's names, in the order they were written in; alpha is never decoded nor multiplied in.
/// Throws `InputError` for unreadable, truncated, empty or absurdly large files and for values that are not finite.
enum class Encoding { automatic, raw };
Image read_image(const std::filesystem::path& file, Encoding encoding = Encoding::automatic);

/// Writes EXR (half for three or fewer channels within its range of ±65504, float otherwise; any channel names), HDR
/// (linear) or 8-bit PNG/JPEG/TIFF (sRGB-encoded, clamped), by extension, atomically. Throws `OutputError`.
void write_image(const std::filesystem::path& file, const Image& image);

float srgb_from_linear(float linear);
float linear_from_srgb(float encoded);

}  // namespace vultus
