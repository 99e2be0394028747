#include "apps/review_encoding.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace vultus::apps {
namespace {

static_assert(std::endian::native == std::endian::little, "the page's arrays are little-endian");

template <typename T>
std::string base64_of(std::span<const T> values) {
  return base64(std::string_view(reinterpret_cast<const char*>(values.data()), values.size_bytes()));
}

std::string replaced(std::string_view text, std::string_view what, std::string_view with) {
  std::string result;
  result.reserve(text.size());
  std::size_t start = 0;
  for (;;) {
    const std::size_t found = text.find(what, start);
    result += text.substr(start, found - start);
    if (found == std::string_view::npos) return result;
    result += with;
    start = found + what.size();
  }
}

}  // namespace

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string result;
  result.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (k < count ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      result += k <= count ? digits[group >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return result;
}

std::string base64(std::span<const std::uint8_t> values) { return base64_of(values); }
std::string base64(std::span<const std::uint16_t> values) { return base64_of(values); }
std::string base64(std::span<const std::int16_t> values) { return base64_of(values); }
std::string base64(std::span<const std::uint32_t> values) { return base64_of(values); }

std::vector<std::uint16_t> quantized(std::span<const float> values, double unit) {
  std::vector<std::uint16_t> result;
  result.reserve(values.size());
  for (float value : values) {
    result.push_back(std::isnan(value)
                         ? std::uint16_t{65535}
                         : static_cast<std::uint16_t>(std::clamp(std::round(value / unit), 0.0, 65534.0)));
  }
  return result;
}

std::string script_text(std::string_view text) { return replaced(replaced(text, "</", "<\\/"), "<!--", "<\\!--"); }

std::string style_text(std::string_view text) { return replaced(text, "</", "<\\/"); }

}  // namespace vultus::apps
