#include "apps/review_pictures.h"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <set>
#include <vector>

#include "apps/review_encoding.h"
#include "core/files.h"
#include "core/image.h"

namespace vultus::apps {
namespace fs = std::filesystem;
namespace {

struct Picture {
  int frame;
  fs::path file;
};

/// "frame_0042.png", "42.jpg" → 42.
std::optional<int> frame_number(const fs::path& file) {
  const std::string stem = file.stem().string();
  std::size_t start = stem.size();
  while (start > 0 && stem[start - 1] >= '0' && stem[start - 1] <= '9') --start;
  int number = 0;
  const auto parsed = std::from_chars(stem.data() + start, stem.data() + stem.size(), number);
  if (start == stem.size() || parsed.ec != std::errc()) return {};
  return number;
}

std::vector<Picture> pictures_in(const fs::path& folder) {
  std::vector<Picture> pictures;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string extension = entry.path().extension().string();
    const std::optional<int> frame = frame_number(entry.path());
    if (frame && (extension == ".png" || extension == ".jpg")) pictures.push_back({*frame, entry.path()});
  }
  std::sort(pictures.begin(), pictures.end(), [](const Picture& a, const Picture& b) {
    return a.frame != b.frame ? a.frame < b.frame : a.file < b.file;
  });
  return pictures;
}

std::vector<Picture> evenly_spread(const std::vector<Picture>& pictures, int most) {
  if (static_cast<int>(pictures.size()) <= most) return pictures;
  std::vector<Picture> chosen;
  for (int i = 0; i < most; ++i) {
    chosen.push_back(pictures[static_cast<std::size_t>(i) * (pictures.size() - 1) / std::max(most - 1, 1)]);
  }
  return chosen;
}

/// Mean over the source pixels under each target pixel, in linear light.
Image reduced(const Image& image, int width) {
  if (image.width() <= width) return image;
  const int height =
      std::max(1, static_cast<int>(std::lround(static_cast<double>(image.height()) * width / image.width())));
  Image small = Image::rgb(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int x0 = x * image.width() / width, x1 = std::max(x0 + 1, (x + 1) * image.width() / width);
      const int y0 = y * image.height() / height, y1 = std::max(y0 + 1, (y + 1) * image.height() / height);
      Eigen::Vector3f sum = Eigen::Vector3f::Zero();
      for (int sy = y0; sy < y1; ++sy) {
        for (int sx = x0; sx < x1; ++sx) sum += image.rgb_at(sx, sy);
      }
      small.set_rgb(x, y, sum / static_cast<float>((x1 - x0) * (y1 - y0)));
    }
  }
  return small;
}

/// A file name nobody else uses, gone at the end.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& extension) {
    std::string pattern = (fs::temp_directory_path() / "vultus_review_XXXXXX").string() + extension;
    const int handle = mkstemps(pattern.data(), static_cast<int>(extension.size()));
    if (handle >= 0) close(handle);
    path_ = pattern;
  }
  ~TemporaryFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::string link_from(const fs::path& page_folder, const fs::path& file) {
  return fs::absolute(file)
      .lexically_normal()
      .lexically_relative(fs::absolute(page_folder).lexically_normal())
      .generic_string();
}

}  // namespace

nlohmann::json inlined_picture(const fs::path& file, int width) {
  const Image image = read_image(file);
  const Image small = reduced(image, width);
  const TemporaryFile jpeg(".jpg");
  write_image(jpeg.path(), small);
  return {{"src", "data:image/jpeg;base64," + base64(read_file(jpeg.path()))},
          {"width", image.width()},
          {"height", image.height()}};
}

nlohmann::json pictures_json(const fs::path& folder, const fs::path& page_folder, const PictureOptions& options,
                             Progress& progress) {
  nlohmann::json result = nlohmann::json::array();
  for (const char* mode : {"", "reference", "realtime"}) {
    const std::vector<Picture> pictures = evenly_spread(pictures_in(folder / mode), options.most);
    for (const Picture& picture : pictures) {
      progress.check();
      nlohmann::json entry = inlined_picture(picture.file, options.width);
      entry["frame"] = picture.frame;
      entry["mode"] = *mode == '\0' ? "render" : mode;
      entry["href"] = link_from(page_folder, picture.file);
      result.push_back(std::move(entry));
      progress.advance();
    }
  }
  return result;
}

nlohmann::json film_json(const fs::path& folder, const fs::path& page_folder, const PictureOptions& options) {
  std::set<fs::path> films;
  std::error_code ignored;
  for (const char* mode : {"", "reference", "realtime"}) {
    for (const auto& entry : fs::directory_iterator(folder / mode, ignored)) {
      if (entry.path().extension() == ".mp4") films.insert(entry.path());
    }
  }
  if (films.empty()) return nullptr;
  const fs::path film = *films.begin();
  nlohmann::json result = {{"href", link_from(page_folder, film)}};
  if (fs::file_size(film) <= options.film_bytes) result["src"] = "data:video/mp4;base64," + base64(read_file(film));
  return result;
}

}  // namespace vultus::apps
