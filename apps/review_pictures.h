#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "core/progress.h"

namespace vultus::apps {

struct PictureOptions {
  int width = 560;                    ///< pixels of an inlined picture; wider ones are reduced. ≥ 32
  int most = 48;                      ///< pictures of one folder, spread evenly over its frames. ≥ 1
  std::size_t film_bytes = 8U << 20;  ///< films up to this size are inlined, others linked
};

/// The rendered frames of one take: [{"frame", "mode", "src": data URI, "href": path from the page, "width",
/// "height"}…] by mode and frame, and {"src" | "href"} of its film or null. `folder` is SESSION/render/<take>; pictures
/// are files whose name ends in a frame number.
nlohmann::json pictures_json(const std::filesystem::path& folder, const std::filesystem::path& page_folder,
                             const PictureOptions& options, Progress& progress);
nlohmann::json film_json(const std::filesystem::path& folder, const std::filesystem::path& page_folder,
                         const PictureOptions& options);

/// One picture as a JPEG data URI, at most `width` pixels wide.
nlohmann::json inlined_picture(const std::filesystem::path& file, int width);

}  // namespace vultus::apps
