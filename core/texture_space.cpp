#include "core/texture_space.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace vultus {
namespace {

/// Barycentric coordinates in a UV triangle, linear in the point.
struct UvTriangle {
  Eigen::Vector2d a, b, c;
  double area2;  // twice the signed area

  UvTriangle(const Uvs& uvs, const Triangles& corners, Eigen::Index t)
      : a(uvs.row(corners(t, 0))), b(uvs.row(corners(t, 1))), c(uvs.row(corners(t, 2))), area2(cross(b - a, c - a)) {}

  static double cross(const Eigen::Vector2d& p, const Eigen::Vector2d& q) { return p.x() * q.y() - p.y() * q.x(); }
  Eigen::Vector3d barycentric(const Eigen::Vector2d& p) const {
    const double u = cross(b - p, c - p) / area2, v = cross(c - p, a - p) / area2;
    return {u, v, 1.0 - u - v};
  }
};

constexpr double edge_tolerance = 1e-9;  // a centre on a shared edge belongs to the first triangle and is no overlap

struct TexelRange {
  int begin, end;
};

/// Texels whose centres (i + 0.5) / n may lie in [low, high].
TexelRange texels_between(double low, double high, int n) {
  const double first = std::clamp(std::floor(low * n - 0.5), 0.0, static_cast<double>(n));
  const double last = std::clamp(std::ceil(high * n - 0.5) + 1.0, 0.0, static_cast<double>(n));
  return {static_cast<int>(first), static_cast<int>(last)};
}

}  // namespace

TextureSpace::TextureSpace(std::shared_ptr<const Topology> topology, int width, int height)
    : topology_(std::move(topology)), width_(width), height_(height) {
  if (!topology_->has_uvs()) throw InputError("the topology has no UVs, so it has no texture space");
  if (width < 1 || height < 1 || width > 65536 || height > 65536)
    throw InputError("texture space of " + std::to_string(width) + "x" + std::to_string(height) +
                     " texels; each side must be 1 to 65536");
  texels_.resize(static_cast<std::size_t>(width) * height);
  std::vector<bool> inside(texels_.size(), false), overlaps(texels_.size(), false);
  const Triangles& corners = topology_->triangle_uvs();
  for (Eigen::Index t = 0; t < corners.rows(); ++t) {
    const UvTriangle triangle(topology_->uvs(), corners, t);
    if (triangle.area2 == 0.0 || !std::isfinite(triangle.area2)) continue;
    const Eigen::Vector2d low = triangle.a.cwiseMin(triangle.b).cwiseMin(triangle.c);
    const Eigen::Vector2d high = triangle.a.cwiseMax(triangle.b).cwiseMax(triangle.c);
    const TexelRange columns = texels_between(low.x(), high.x(), width);
    const TexelRange rows = texels_between(1.0 - high.y(), 1.0 - low.y(), height);
    for (int y = rows.begin; y < rows.end; ++y) {
      for (int x = columns.begin; x < columns.end; ++x) {
        const Eigen::Vector3d weights = triangle.barycentric({(x + 0.5) / width, 1.0 - (y + 0.5) / height});
        const double lowest = weights.minCoeff();
        if (lowest < -edge_tolerance) continue;
        const std::size_t i = static_cast<std::size_t>(y) * width + x;
        const bool interior = lowest > edge_tolerance;
        if (interior && inside[i]) overlaps[i] = true;
        inside[i] = inside[i] || interior;
        if (texels_[i].valid()) continue;
        const Eigen::Vector3d clamped = weights.cwiseMax(0.0);
        texels_[i] = {static_cast<int>(t), clamped / clamped.sum()};
      }
    }
  }
  overlapping_ = static_cast<int>(std::count(overlaps.begin(), overlaps.end(), true));
}

Image TextureSpace::bake(const Eigen::MatrixXf& vertex_values, std::vector<std::string> channel_names) const {
  if (vertex_values.rows() != topology_->vertex_count() ||
      vertex_values.cols() != static_cast<Eigen::Index>(channel_names.size()))
    throw InputError("baking " + std::to_string(vertex_values.rows()) + "x" + std::to_string(vertex_values.cols()) +
                     " values for " + std::to_string(topology_->vertex_count()) + " vertices and " +
                     std::to_string(channel_names.size()) + " channels");
  Image image(width_, height_, std::move(channel_names));
  const Triangles& triangles = topology_->triangles();
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const SurfacePoint& place = at(x, y);
      if (!place.valid()) continue;
      const Eigen::Vector3f weights = place.barycentric.cast<float>();
      float* texel = image.at(x, y);
      for (int c = 0; c < image.channels(); ++c)
        for (int k = 0; k < 3; ++k) texel[c] += weights[k] * vertex_values(triangles(place.triangle, k), c);
    }
  }
  dilate(image, std::max(4, std::min(width_, height_) / 64));
  return image;
}

void TextureSpace::dilate(Image& image, int gutter) const {
  if (image.width() != width_ || image.height() != height_)
    throw InputError("dilating an image of another size than the texture space");
  constexpr int dx[] = {1, -1, 0, 0, 1, 1, -1, -1}, dy[] = {0, 0, 1, -1, 1, -1, 1, -1};
  std::vector<bool> filled(texels_.size());
  for (std::size_t i = 0; i < texels_.size(); ++i) filled[i] = texels_[i].valid();
  const auto each_neighbour = [&](int i, const auto& visit) {
    for (int k = 0; k < 8; ++k) {
      const int x = i % width_ + dx[k], y = i / width_ + dy[k];
      if (x >= 0 && y >= 0 && x < width_ && y < height_) visit(y * width_ + x);
    }
  };
  std::vector<int> front;  // filled texels whose empty neighbours are the next ring
  for (int i = 0; i < width_ * height_; ++i) {
    bool at_edge = false;
    if (filled[i]) each_neighbour(i, [&](int n) { at_edge = at_edge || !filled[n]; });
    if (at_edge) front.push_back(i);
  }
  for (int ring = 0; ring < gutter && !front.empty(); ++ring) {
    std::vector<int> next;
    for (const int i : front)
      each_neighbour(i, [&](int n) {
        if (!filled[n]) next.push_back(n);
      });
    std::sort(next.begin(), next.end());
    next.erase(std::unique(next.begin(), next.end()), next.end());
    for (const int i : next) {
      int count = 0;
      float* texel = image.at(i % width_, i / width_);
      std::fill(texel, texel + image.channels(), 0.0f);
      each_neighbour(i, [&](int n) {
        if (!filled[n]) return;
        ++count;
        for (int c = 0; c < image.channels(); ++c) texel[c] += image.at(n % width_, n / width_)[c];
      });
      for (int c = 0; c < image.channels(); ++c) texel[c] /= static_cast<float>(count);
    }
    for (const int i : next) filled[i] = true;
    front = std::move(next);
  }
}

Eigen::Vector2d TextureSpace::uv(const SurfacePoint& place) const {
  Eigen::Vector2d result = Eigen::Vector2d::Zero();
  for (int k = 0; k < 3; ++k)
    result += place.barycentric[k] * topology_->uvs().row(topology_->triangle_uvs()(place.triangle, k)).transpose();
  return result;
}

float TextureSpace::sample(const Image& map, const SurfacePoint& place, int channel) const {
  const Eigen::Vector2d at_uv = uv(place);
  return map.sample(at_uv.x() * map.width(), (1.0 - at_uv.y()) * map.height(), channel);
}

Uvs TextureSpace::vertex_uvs() const {
  Uvs result = Uvs::Zero(topology_->vertex_count(), 2);
  std::vector<bool> known(topology_->vertex_count(), false);
  const TopologyData& data = topology_->data();
  for (std::size_t corner = 0; corner < data.corner_vertex.size(); ++corner) {
    const int v = data.corner_vertex[corner];
    if (known[v]) continue;
    result.row(v) = data.uvs.row(data.corner_uv[corner]);
    known[v] = true;
  }
  return result;
}

}  // namespace vultus
