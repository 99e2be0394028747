#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vultus::apps {

/// RFC 4648 base64 with padding.
std::string base64(std::string_view bytes);
/// The little-endian bytes of an array, as base64; JavaScript reads them back with a typed array.
std::string base64(std::span<const std::uint8_t> values);
std::string base64(std::span<const std::uint16_t> values);
std::string base64(std::span<const std::int16_t> values);
std::string base64(std::span<const std::uint32_t> values);

/// Steps of `unit` from 0, rounded, at most 65534; 65535 stands for NaN.
std::vector<std::uint16_t> quantized(std::span<const float> values, double unit);

/// Rows of `width` values for the page: quantized, every n-th row such that at most `most` values remain: {"stride",
/// "width", "step", "data"}.
nlohmann::json rows_json(const std::vector<float>& values, std::size_t width, std::size_t most, double step);
/// Four decimals, enough for the page; null where there is no value.
nlohmann::json finite_or_null(double value);

/// Text that may stand between <script> tags: a "</script" or "<!--" inside is written with a backslash after the '<',
/// which JavaScript strings read as the same text. Not for JSON, which has no such escape.
std::string script_text(std::string_view text);
/// JSON that may stand between <script> tags: every '<' as \u003c.
std::string json_text(std::string_view json);
/// Text of an HTML element or of an attribute in double quotes.
std::string html_text(std::string_view text);
/// Text between <style> tags.
std::string style_text(std::string_view text);

}  // namespace vultus::apps
