#include "apps/bench_registration/heat_map.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/image.h"
#include "core/rays.h"

namespace vultus::apps::bench {
namespace {

constexpr int size = 420;  // pixels a view

// Blue, cyan, green, yellow, red at equal steps.
Eigen::Vector3f heat(double value) {
  const std::array<Eigen::Vector3f, 5> stops = {Eigen::Vector3f(0.05F, 0.1F, 0.7F), Eigen::Vector3f(0.0F, 0.55F, 0.7F),
                                                Eigen::Vector3f(0.1F, 0.6F, 0.1F), Eigen::Vector3f(0.9F, 0.75F, 0.0F),
                                                Eigen::Vector3f(0.75F, 0.02F, 0.02F)};
  const double at = std::clamp(value, 0.0, 1.0) * (stops.size() - 1);
  const std::size_t below = std::min(stops.size() - 2, static_cast<std::size_t>(at));
  const float share = static_cast<float>(at - static_cast<double>(below));
  return (1.0F - share) * stops[below] + share * stops[below + 1];
}

// One orthographic view turned by `yaw` about the upright axis, into columns [left, left + size).
void draw(Image& image, int left, const Mesh& mesh, const Points& colours, const Box& box, double yaw) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const RayScene scene(*mesh.topology, mesh.positions);
  const Points normals = vertex_normals(*mesh.topology, mesh.positions);
  const double width = 1.15 * (box.max - box.min).head<2>().maxCoeff();
  tbb::parallel_for(0, size, [&](int y) {
    for (int x = 0; x < size; ++x) {
      const Eigen::Vector3d in_view(width * ((x + 0.5) / size - 0.5), width * (0.5 - (y + 0.5) / size), 500.0);
      const auto hit = scene.hit(box.centre() + turn * in_view, turn * -Eigen::Vector3d::UnitZ());
      if (!hit) continue;
      const Eigen::Vector3d normal = position_of(hit->place, *mesh.topology, normals).normalized();
      const double shade = 0.35 + 0.65 * std::max(0.0, normal.dot(turn * Eigen::Vector3d(0.2, 0.35, 0.9).normalized()));
      image.set_rgb(left + x, y, (shade * position_of(hit->place, *mesh.topology, colours)).cast<float>());
    }
  });
}

}  // namespace

void write_heat_map(const std::filesystem::path& file, const Mesh& mesh, const Eigen::VectorXf& distance,
                    const std::vector<bool>& shown, double full_scale) {
  Points colours(mesh.positions.rows(), 3);
  std::vector<int> face;
  for (int v = 0; v < colours.rows(); ++v) {
    const bool known = shown[v] && std::isfinite(distance[v]);
    const Eigen::Vector3f colour = known ? heat(distance[v] / full_scale) : Eigen::Vector3f::Constant(0.35F);
    colours.row(v) = colour.cast<double>().transpose();
    if (shown[v]) face.push_back(v);
  }
  const Box box = bounds(mesh.positions(face, Eigen::all));
  Image image = Image::rgb(3 * size, size);
  draw(image, 0, mesh, colours, box, -0.9);
  draw(image, size, mesh, colours, box, 0.0);
  draw(image, 2 * size, mesh, colours, box, 0.9);
  write_image(file, image);
}

}  // namespace vultus::apps::bench
