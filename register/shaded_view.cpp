#include "register/shaded_view.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "register/calmed_normals.h"

namespace vultus::registration {
namespace {

// About 2 mm on a head, whatever the scan's density.
int smoothing_rounds(const Mesh& scan) {
  const double size = bounds(scan.positions).diagonal();
  const double spacing = size / std::sqrt(std::max(1, scan.topology->vertex_count()));
  return std::clamp(static_cast<int>(0.01 * size / spacing), 1, 8);
}

// Nearest 8-bit sRGB level of a linear value.
std::uint8_t encoded(double linear) {
  return static_cast<std::uint8_t>(
      std::lround(255 * srgb_from_linear(static_cast<float>(std::clamp(linear, 0.0, 1.0)))));
}

}  // namespace

ScanPictures::ScanPictures(const Mesh& scan)
    : scan_(&scan), rays_(*scan.topology, scan.positions), normals_(calmed_normals(scan, smoothing_rounds(scan))) {
  if (scan.has_colours() || scan.texture.empty() || !scan.topology->has_uvs()) return;
  try {
    texture_ = read_image(scan.texture);
  } catch (const Error&) {
    texture_ = Image();  // shape alone is enough to go on
  }
}

Eigen::Vector3d ScanPictures::normal(const SurfacePoint& place) const {
  return position_of(place, *scan_->topology, normals_).normalized();
}

double ScanPictures::albedo(const SurfacePoint& place) const {
  const Eigen::Vector3d luminance(0.2126, 0.7152, 0.0722);
  if (scan_->has_colours()) return luminance.dot(position_of(place, *scan_->topology, scan_->colours));
  if (texture_.empty()) return 0.55;
  const auto rows = scan_->topology->triangle_uvs().row(place.triangle);
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();
  for (int k = 0; k < 3; ++k) uv += place.barycentric[k] * scan_->topology->uvs().row(rows[k]).transpose();
  const double x = uv.x() * texture_.width(), y = (1.0 - uv.y()) * texture_.height();
  if (texture_.channels() < 3) return texture_.sample(x, y, 0);
  return luminance.dot(Eigen::Vector3d(texture_.sample(x, y, 0), texture_.sample(x, y, 1), texture_.sample(x, y, 2)));
}

std::vector<GreyImage> ScanPictures::shade(const Camera& camera, std::span<const Eigen::Vector3d> lights) const {
  const GreyImage blank{camera.width, camera.height,
                        std::vector<std::uint8_t>(std::size_t(camera.width) * camera.height)};
  std::vector<GreyImage> pictures(lights.size(), blank);
  std::vector<Eigen::Vector3d> world_lights;
  for (const Eigen::Vector3d& light : lights)
    world_lights.push_back(camera.camera_from_world_rotation.transpose() * light.normalized());
  const Eigen::Vector3d eye = camera.centre();
  const double ambient = coloured() ? 0.45 : 0.12;  // colour carries the features itself; bare shape needs contrast
  const std::uint8_t background = encoded(0.02);
  tbb::parallel_for(0, camera.height, [&](int y) {
    for (int x = 0; x < camera.width; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * camera.width + x;
      const auto hit = rays_.hit(eye, camera.direction(x + 0.5, y + 0.5));
      const Eigen::Vector3d facing = hit ? normal(hit->place) : Eigen::Vector3d();
      const double colour = hit ? albedo(hit->place) : 0.0;
      for (std::size_t i = 0; i < lights.size(); ++i) {
        const double lambert = hit ? std::max(0.0, facing.dot(world_lights[i])) : 0.0;
        pictures[i].pixels[pixel] = hit ? encoded(colour * (ambient + (1.0 - ambient) * lambert)) : background;
      }
    }
  });
  return pictures;
}

}  // namespace vultus::registration
