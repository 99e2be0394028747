#include "apps/review_encoding.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>

namespace vultus::apps {
namespace {

static_assert(std::endian::native == std::endian::little, "the page's arrays are little-endian");

template <typename T>
std::string base64_of(std::span<const T> values) {
  return base64(std::string_view(reinterpret_cast<const char*>(values.data()), values.size_bytes()));
}

bool same_letters(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

/// A backslash after the '<' of every `what` (in any case).
std::string broken_up(std::string_view text, std::string_view what) {
  std::string result;
  result.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    result += text[i];
    if (text[i] == '<' && same_letters(text.substr(i, what.size()), what)) result += '\\';
  }
  return result;
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

nlohmann::json rows_json(const std::vector<float>& values, std::size_t width, std::size_t most, double step) {
  const std::size_t stride = std::max<std::size_t>(1, (values.size() + most - 1) / most);
  std::vector<float> kept;
  for (std::size_t start = 0; start + width <= values.size(); start += stride * width) {
    kept.insert(kept.end(), values.begin() + static_cast<std::ptrdiff_t>(start),
                values.begin() + static_cast<std::ptrdiff_t>(start + width));
  }
  return {{"stride", stride},
          {"width", width},
          {"step", step},
          {"data", base64(std::span<const std::uint16_t>(quantized(kept, step)))}};
}

nlohmann::json finite_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(std::round(value * 1e4) / 1e4) : nlohmann::json(nullptr);
}

std::string script_text(std::string_view text) { return broken_up(broken_up(text, "</script"), "<!--"); }

std::string json_text(std::string_view json) {
  std::string result;
  result.reserve(json.size());
  for (char c : json) {
    if (c == '<') {
      result += "\\u003c";
    } else {
      result += c;
    }
  }
  return result;
}

std::string html_text(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '&') {
      result += "&amp;";
    } else if (c == '<') {
      result += "&lt;";
    } else if (c == '>') {
      result += "&gt;";
    } else if (c == '"') {
      result += "&quot;";
    } else {
      result += c;
    }
  }
  return result;
}

std::string style_text(std::string_view text) { return broken_up(text, "</style"); }

}  // namespace vultus::apps
