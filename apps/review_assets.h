#pragma once

#include <string_view>

namespace vultus::apps {

/// A file of apps/review/, kept in the binary by CMake (cmake/EmbedText.cmake). Only names that exist are asked for.
std::string_view review_asset(std::string_view name);

}  // namespace vultus::apps
