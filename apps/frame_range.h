#pragma once

#include <string>
#include <utility>

namespace vultus::apps {

/// Frames "A:B" of a take of `frames`: A up to but not including B, from 0; either may be left out, and "A" alone is
/// that frame. Throws `UsageError` for anything else and for frames the take does not have.
std::pair<int, int> frame_range(const std::string& text, int frames);

/// "WIDTHxHEIGHT" in pixels; throws `UsageError`.
std::pair<int, int> picture_size(const std::string& text);

}  // namespace vultus::apps
