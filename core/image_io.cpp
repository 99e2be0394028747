#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <set>

#include "core/error.h"
#include "core/files.h"
#include "core/image.h"

namespace vultus {
namespace {

constexpr int max_side = 1 << 17;  // pixels
constexpr int max_channels = 1024;
constexpr std::size_t free_values = 1 << 26;              // decoded values accepted whatever the size of the file
constexpr std::size_t max_expansion = 4096;               // decoded values a byte of a larger file may stand for
constexpr const char* channel_order = "vultus:channels";  // EXR itself keeps channels in alphabetical order

std::string lower_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension;
}

void check_readable(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) throw InputError(file, "no such file");
  if (std::filesystem::is_directory(file, error)) throw InputError(file, "is a folder, not an image");
  if (!std::ifstream(file, std::ios::binary)) throw InputError(file, "cannot be opened (no permission)");
  if (std::filesystem::file_size(file, error) == 0) throw InputError(file, "byte 0", "the file is empty");
}

void check_size(const std::filesystem::path& file, const OIIO::ImageSpec& spec) {
  const std::string size = std::to_string(spec.width) + "x" + std::to_string(spec.height) + ", " +
                           std::to_string(spec.nchannels) + " channels";
  if (spec.width <= 0 || spec.height <= 0 || spec.nchannels <= 0)
    throw InputError(file, "header", "the image is empty (" + size + ")");
  if (spec.depth > 1) throw InputError(file, "header", "volumes are not supported");
  if (spec.deep) throw InputError(file, "header", "deep images are not supported");
  const std::size_t values = static_cast<std::size_t>(spec.width) * spec.height * spec.nchannels;
  const bool absurd = spec.width > max_side || spec.height > max_side || spec.nchannels > max_channels ||
                      (values > free_values && values / max_expansion > std::filesystem::file_size(file));
  if (absurd) throw InputError(file, "header", "the image is absurdly large (" + size + ")");
}

/// libjpeg pads a truncated file with grey and only warns; a whole one ends with the end-of-image marker.
void check_jpeg_end(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const auto size = std::filesystem::file_size(file);
  const auto tail = std::min<std::uintmax_t>(size, 4096);  // some cameras append padding
  std::string bytes(tail, '\0');
  stream.seekg(static_cast<std::streamoff>(size - tail));
  stream.read(bytes.data(), static_cast<std::streamsize>(tail));
  if (bytes.rfind("\xff\xd9") == std::string::npos)
    throw InputError(file, "byte " + std::to_string(size), "truncated: no JPEG end-of-image marker");
}

bool is_srgb(const OIIO::ImageSpec& spec) {
  const std::string space = spec.get_string_attribute("oiio:ColorSpace");
  if (space == "sRGB" || space.starts_with("Gamma")) return true;
  if (space.starts_with("linear") || space.starts_with("Linear")) return false;
  return spec.format.basesize() == 1;
}

void decode_srgb(Image& image, int alpha_channel) {
  const int channels = image.channels();
  auto& pixels = image.pixels();
  for (std::size_t i = 0; i < pixels.size(); ++i)
    if (static_cast<int>(i % channels) != alpha_channel) pixels[i] = linear_from_srgb(pixels[i]);
}

void check_finite(const std::filesystem::path& file, const Image& image) {
  const auto& pixels = image.pixels();
  const auto bad = std::find_if(pixels.begin(), pixels.end(), [](float value) { return !std::isfinite(value); });
  if (bad == pixels.end()) return;
  const std::size_t index = bad - pixels.begin(), pixel = index / image.channels();
  throw InputError(file,
                   "pixel (" + std::to_string(pixel % image.width()) + ", " + std::to_string(pixel / image.width()) +
                       "), channel " + image.channel_names()[index % image.channels()],
                   "the value is not finite");
}

std::vector<std::string> split_lines(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    lines.push_back(text.substr(start, end - start));
    start = end + 1;
  }
  return lines;
}

/// Channels in the order they had when we wrote them, where the file says so.
Image in_written_order(Image image, const std::string& order) {
  if (order.empty()) return image;
  const std::vector<std::string> wanted = split_lines(order);
  const auto& names = image.channel_names();
  if (wanted == names || !std::is_permutation(wanted.begin(), wanted.end(), names.begin(), names.end())) return image;
  std::vector<int> from;
  for (const auto& name : wanted)
    from.push_back(static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin()));
  Image result(image.width(), image.height(), wanted);
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      for (std::size_t c = 0; c < from.size(); ++c) result.at(x, y)[c] = image.at(x, y)[from[c]];
  return result;
}

struct Coding {
  OIIO::TypeDesc type;
  bool srgb;
  int max_channels;
};

Coding coding_for(const std::filesystem::path& file, const Image& image) {
  const std::string extension = lower_extension(file);
  if (extension == ".exr") {
    const auto& p = image.pixels();
    const bool fits_half = std::all_of(p.begin(), p.end(), [](float value) { return std::abs(value) <= 65504.0f; });
    return {image.channels() <= 3 && fits_half ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT, false, max_channels};
  }
  if (extension == ".hdr") return {OIIO::TypeDesc::FLOAT, false, 3};
  if (extension == ".png") return {OIIO::TypeDesc::UINT8, true, 4};
  if (extension == ".jpg" || extension == ".jpeg") return {OIIO::TypeDesc::UINT8, true, 3};
  if (extension == ".tif" || extension == ".tiff") return {OIIO::TypeDesc::UINT8, true, max_channels};
  throw OutputError(file, "unknown image extension; .exr, .hdr, .png, .jpg and .tif can be written");
}

std::vector<float> encoded_pixels(const Image& image, bool srgb, int alpha_channel) {
  std::vector<float> values = image.pixels();
  if (!srgb) return values;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const float value = values[i] > 0.0f ? std::min(values[i], 1.0f) : 0.0f;  // also takes NaN to 0
    values[i] = static_cast<int>(i % image.channels()) == alpha_channel ? value : srgb_from_linear(value);
  }
  return values;
}

void check_writable(const std::filesystem::path& file, const Image& image, const Coding& coding) {
  if (image.empty()) throw OutputError(file, "the image is empty");
  if (image.channels() > coding.max_channels)
    throw OutputError(file, std::to_string(image.channels()) + " channels do not fit this format; use .exr");
  const std::set<std::string> unique(image.channel_names().begin(), image.channel_names().end());
  if (static_cast<int>(unique.size()) != image.channels()) throw OutputError(file, "two channels have the same name");
}

void write_with_oiio(const std::filesystem::path& path, const std::filesystem::path& file, const Image& image,
                     const Coding& coding) {
  const auto output = OIIO::ImageOutput::create(path.string());
  if (!output) throw OutputError(file, OIIO::geterror());
  OIIO::ImageSpec spec(image.width(), image.height(), image.channels(), coding.type);
  spec.channelnames = image.channel_names();
  const auto alpha = std::find(spec.channelnames.begin(), spec.channelnames.end(), "A");
  spec.alpha_channel = alpha == spec.channelnames.end() ? -1 : static_cast<int>(alpha - spec.channelnames.begin());
  spec.attribute("oiio:ColorSpace", coding.srgb ? "sRGB" : "linear");
  spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("DateTime", "1970:01:01 00:00:00");  // equal images make equal files
  if (coding.type == OIIO::TypeDesc::UINT8) spec.attribute("CompressionQuality", 95);
  if (lower_extension(file) == ".exr") {
    spec.attribute("compression", "zip");
    std::string order;
    for (const auto& name : image.channel_names()) order += (order.empty() ? "" : "\n") + name;
    spec.attribute(channel_order, order);
  }
  const std::vector<float> values = encoded_pixels(image, coding.srgb, spec.alpha_channel);
  if (!output->open(path.string(), spec) || !output->write_image(OIIO::TypeDesc::FLOAT, values.data()) ||
      !output->close())
    throw OutputError(file, output->geterror());
}

}  // namespace

Image read_image(const std::filesystem::path& file, Encoding encoding) {
  check_readable(file);
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);  // colours as the file has them, not multiplied by alpha
  const auto input = OIIO::ImageInput::open(file.string(), &config);
  if (!input) throw InputError(file, "not an image that can be read: " + OIIO::geterror());
  const OIIO::ImageSpec spec = input->spec();
  check_size(file, spec);
  if (std::string_view(input->format_name()) == "jpeg") check_jpeg_end(file);
  if (std::set<std::string>(spec.channelnames.begin(), spec.channelnames.end()).size() != spec.channelnames.size())
    throw InputError(file, "header", "two channels have the same name");

  Image image(spec.width, spec.height, spec.channelnames);
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.pixels().data()))
    throw InputError(file, "pixels", "damaged or truncated: " + input->geterror());
  check_finite(file, image);
  if (encoding == Encoding::automatic && is_srgb(spec)) decode_srgb(image, spec.alpha_channel);
  return in_written_order(std::move(image), spec.get_string_attribute(channel_order));
}

void write_image(const std::filesystem::path& file, const Image& image) {
  const Coding coding = coding_for(file, image);
  check_writable(file, image, coding);
  write_file_with(file, [&](const std::filesystem::path& path) { write_with_oiio(path, file, image, coding); });
}

}  // namespace vultus
