#include "register/face_finder.h"

#include <dlib/image_processing.h>
#include <dlib/image_processing/frontal_face_detector.h>

#include <algorithm>
#include <cstdlib>

#include "core/error.h"

namespace vultus::registration {
namespace fs = std::filesystem;

struct FaceFinder::Impl {
  dlib::frontal_face_detector detector = dlib::get_frontal_face_detector();
  dlib::shape_predictor predictor;
};

fs::path FaceFinder::find_model() {
  const std::string name = "shape_predictor_68_face_landmarks.dat";
  std::error_code ignored;
  if (const char* given = std::getenv("VULTUS_DLIB_MODEL"); given && *given) {
    if (fs::is_regular_file(given, ignored)) return given;
    throw ToolError("VULTUS_DLIB_MODEL names no file: " + std::string(given));
  }
  for (const char* folder : {"/usr/share/dlib", "/usr/local/share/dlib"})
    if (fs::is_regular_file(fs::path(folder) / name, ignored)) return fs::path(folder) / name;
  throw ToolError(
      "automatic landmarks need dlib's 68-point model: apt install libdlib-data, or set VULTUS_DLIB_MODEL to " + name +
      ", or give landmarks/<pose>.json");
}

FaceFinder::FaceFinder(const fs::path& model) {
  auto impl = std::make_unique<Impl>();
  try {
    dlib::deserialize(model.string()) >> impl->predictor;
  } catch (const std::exception& problem) {
    throw InputError(model, std::string("is not a dlib shape predictor: ") + problem.what());
  }
  if (impl->predictor.num_parts() != 68)
    throw InputError(model, "predicts " + std::to_string(impl->predictor.num_parts()) + " points instead of 68");
  impl_ = std::move(impl);
}

FaceFinder::~FaceFinder() = default;

std::vector<FoundFace> FaceFinder::find_all(const GreyImage& picture, double least_score, int most) const {
  dlib::array2d<unsigned char> image(picture.height, picture.width);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      image[y][x] = picture.pixels[static_cast<std::size_t>(y) * picture.width + x];
  dlib::frontal_face_detector detector = impl_->detector;  // detecting changes the detector's scratch memory
  std::vector<dlib::rect_detection> faces;
  detector(image, faces, least_score);
  std::stable_sort(faces.begin(), faces.end(),
                   [](const auto& a, const auto& b) { return a.detection_confidence > b.detection_confidence; });
  if (static_cast<int>(faces.size()) > most) faces.resize(most);
  std::vector<FoundFace> found;
  for (const dlib::rect_detection& face : faces) {
    const dlib::full_object_detection shape = impl_->predictor(image, face.rect);
    found.push_back({face.detection_confidence, {}});
    for (int i = 0; i < 68; ++i) found.back().points[i] = {shape.part(i).x() + 0.5, shape.part(i).y() + 0.5};
  }
  return found;
}

std::optional<FoundFace> FaceFinder::find(const GreyImage& picture, double least_score) const {
  const std::vector<FoundFace> faces = find_all(picture, least_score, 1);
  if (faces.empty()) return {};
  return faces.front();
}

}  // namespace vultus::registration
