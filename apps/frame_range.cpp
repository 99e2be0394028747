#include "apps/frame_range.h"

#include <charconv>
#include <string_view>

#include "core/error.h"

namespace vultus::apps {
namespace {

bool whole_number(std::string_view text, int& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && value >= 0;
}

}  // namespace

std::pair<int, int> frame_range(const std::string& text, int frames) {
  if (text.empty()) return {0, frames};
  const auto colon = text.find(':');
  const std::string_view first_text = std::string_view(text).substr(0, colon);
  int first = 0, last = frames;
  bool is_range = first_text.empty() ? colon != std::string::npos : whole_number(first_text, first);
  if (colon == std::string::npos) {
    last = first + 1;
  } else if (const std::string_view last_text = std::string_view(text).substr(colon + 1); !last_text.empty()) {
    is_range = is_range && whole_number(last_text, last);
  }
  if (!is_range) throw UsageError("--frames \"" + text + "\" is not A:B, such as 0:24");
  if (first >= last || last > frames) {
    throw UsageError("--frames " + text + ": the take has frames 0 to " + std::to_string(frames - 1) +
                     " and A:B ends before B");
  }
  return {first, last};
}

std::pair<int, int> picture_size(const std::string& text) {
  const auto cross = text.find('x');
  int width = 0, height = 0;
  if (cross == std::string::npos || !whole_number(std::string_view(text).substr(0, cross), width) ||
      !whole_number(std::string_view(text).substr(cross + 1), height) || width == 0 || height == 0) {
    throw UsageError("--size \"" + text + "\" is not WIDTHxHEIGHT, such as 512x512");
  }
  return {width, height};
}

}  // namespace vultus::apps
