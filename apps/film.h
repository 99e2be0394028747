#pragma once

#include <filesystem>
#include <vector>

namespace vultus::apps {

/// H.264 film of PNG pictures of one size, in order, by ffmpeg. Throws `ToolError` where ffmpeg is not installed or
/// fails.
void write_film(const std::filesystem::path& film, const std::vector<std::filesystem::path>& pictures, double rate_hz);

}  // namespace vultus::apps
