#pragma once

#include <filesystem>

#include "apps/review_pictures.h"
#include "core/progress.h"

namespace vultus::apps {

struct ReviewOptions {
  std::filesystem::path javascript = "/usr/share/javascript";  ///< where Debian's libjs-dygraphs and libjs-three lie
  PictureOptions pictures;
};

struct ReviewPage {
  std::filesystem::path file;
  std::size_t bytes = 0;
  int findings = 0, takes = 0, pictures = 0;
};

/// Writes SESSION/review/index.html: one file that opens from disk, with everything inside: the 3D head, curves,
/// tables, pictures, and the libraries that draw them. Same session, same bytes. Throws `ToolError` naming the package
/// when a library is not installed, `InputError` as `read_review_session` does.
ReviewPage write_review(const std::filesystem::path& session, const ReviewOptions& options = {},
                        Progress& progress = Progress::none());

}  // namespace vultus::apps
