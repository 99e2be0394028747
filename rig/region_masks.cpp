#include "rig/region_masks.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/texture_space.h"
#include "rig/region_names.h"
#include "rig/uv_charts.h"

namespace vultus::rig {
namespace {

Image rasterise(const TextureSpace& texels, const std::vector<int>& labels, const std::vector<std::string>& names) {
  Image image(texels.width(), texels.height(), names);
  const Triangles& triangles = texels.topology().triangles();
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const SurfacePoint& place = texels.at(x, y);
      if (!place.valid()) continue;
      Eigen::Index corner = 0;
      place.barycentric.maxCoeff(&corner);
      image.at(x, y)[labels[triangles(place.triangle, corner)]] = 1.0F;
    }
  return image;
}

/// Mean over each vertex's UV rows; vertices that no chart shows keep their own label.
Eigen::MatrixXf vertex_means(const Topology& topology, const Eigen::MatrixXf& at_uvs, const std::vector<int>& labels) {
  Eigen::MatrixXf sums = Eigen::MatrixXf::Zero(topology.vertex_count(), at_uvs.cols());
  std::vector<bool> counted(static_cast<std::size_t>(at_uvs.rows()), false);
  Eigen::VectorXf counts = Eigen::VectorXf::Zero(topology.vertex_count());
  const Triangles &triangles = topology.triangles(), &uvs = topology.triangle_uvs();
  for (Eigen::Index t = 0; t < triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int row = uvs(t, k), vertex = triangles(t, k);
      if (counted[row] || std::isnan(at_uvs(row, 0))) continue;
      counted[row] = true;
      sums.row(vertex) += at_uvs.row(row);
      counts[vertex] += 1.0F;
    }
  for (Eigen::Index v = 0; v < sums.rows(); ++v) {
    if (counts[v] > 0.0F)
      sums.row(v) /= counts[v];
    else if (!labels.empty())
      sums(v, labels[static_cast<std::size_t>(v)]) = 1.0F;
  }
  return sums;
}

/// Adds to every texel the interpolated difference between its corners' vertex values and what their chart shows there:
/// zero but for triangles at a seam.
void bend_to_vertices(const TextureSpace& texels, const Eigen::MatrixXf& at_uvs, const Eigen::MatrixXf& at_vertices,
                      Image& image) {
  const Topology& topology = texels.topology();
  const Triangles &triangles = topology.triangles(), &uvs = topology.triangle_uvs();
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const SurfacePoint& place = texels.at(x, y);
      if (!place.valid()) continue;
      Eigen::Map<Eigen::RowVectorXf> texel(image.at(x, y), image.channels());
      for (int k = 0; k < 3; ++k) {
        const int row = uvs(place.triangle, k);
        if (std::isnan(at_uvs(row, 0))) continue;
        texel += static_cast<float>(place.barycentric[k]) *
                 (at_vertices.row(triangles(place.triangle, k)) - at_uvs.row(row));
      }
    }
}

/// Texels of parts apart from the skin show the masks of the vertices.
void bake_followers(const TextureSpace& texels, const std::vector<int>& follows, const Eigen::MatrixXf& at_vertices,
                    Image& image) {
  const Triangles& triangles = texels.topology().triangles();
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const SurfacePoint& place = texels.at(x, y);
      if (!place.valid() || follows[triangles(place.triangle, 0)] < 0) continue;
      Eigen::Map<Eigen::RowVectorXf> texel(image.at(x, y), image.channels());
      texel.setZero();
      for (int k = 0; k < 3; ++k)
        texel += static_cast<float>(place.barycentric[k]) * at_vertices.row(triangles(place.triangle, k));
    }
}

/// Makes a row ≥ 0 with sum one; false when nothing is left of it.
bool normalize(Eigen::Ref<Eigen::RowVectorXf> row) {
  row = row.cwiseMax(0.0F);
  const float sum = row.sum();
  if (!(sum > 0.0F)) return false;
  row /= sum;
  return true;
}

void normalize_texels(const TextureSpace& texels, Image& image) {
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      Eigen::RowVectorXf texel = Eigen::Map<Eigen::RowVectorXf>(image.at(x, y), image.channels());
      if (!normalize(texel) && texels.at(x, y).valid())
        throw InputError("masks: texel (" + std::to_string(x) + ", " + std::to_string(y) +
                         ") shows skin but belongs to no region");
      Eigen::Map<Eigen::RowVectorXf>(image.at(x, y), image.channels()) = texel;
    }
}

/// Fills what no chart covers and normalizes that too.
void fill_empty_texels(const TextureSpace& texels, Image& image) {
  texels.dilate(image, image.width() + image.height());
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      Eigen::RowVectorXf texel = Eigen::Map<Eigen::RowVectorXf>(image.at(x, y), image.channels());
      if (!normalize(texel)) texel[0] = 1.0F;
      Eigen::Map<Eigen::RowVectorXf>(image.at(x, y), image.channels()) = texel;
    }
}

RegionMasks assemble(const std::vector<std::string>& names, const Eigen::MatrixXf& at_vertices, Image masks) {
  RegionMasks result{{}, std::move(masks)};
  for (std::size_t r = 0; r < names.size(); ++r)
    result.regions.push_back({names[r], at_vertices.col(static_cast<Eigen::Index>(r))});
  return result;
}

}  // namespace

void MaskOptions::validate() const {
  if (size < 16 || size > 8192) throw InputError("mask size must be from 16 to 8192 texels");
  if (!(blend_mm >= 0.0) || blend_mm > 100.0) throw InputError("mask blending must be from 0 to 100 mm");
}

RegionMasks region_masks(const Actor& actor, const Segmentation& segmentation, const MaskOptions& options) {
  options.validate();
  const std::vector<std::string> names = region_names(actor, segmentation);
  const TextureSpace texels(actor.topology, options.size, options.size);
  const UvCharts charts = uv_charts(texels, actor.neutral());
  Image masks = rasterise(texels, segmentation.labels, names);
  if (options.blend_mm > 0.0) smooth_in_charts(texels, charts, options.blend_mm, masks);

  const Eigen::MatrixXf at_uvs = sample_at_uvs(texels, charts, masks);
  Eigen::MatrixXf at_vertices = vertex_means(*actor.topology, at_uvs, segmentation.labels);
  for (Eigen::Index v = 0; v < at_vertices.rows(); ++v) {
    Eigen::RowVectorXf row = at_vertices.row(v);
    if (!normalize(row)) row[segmentation.labels[static_cast<std::size_t>(v)]] = 1.0F;
    at_vertices.row(v) = row;
  }
  bend_to_vertices(texels, at_uvs, at_vertices, masks);
  for (Eigen::Index v = 0; v < at_vertices.rows(); ++v)
    if (const int leader = segmentation.follows[static_cast<std::size_t>(v)]; leader >= 0)
      at_vertices.row(v) = at_vertices.row(leader).eval();
  bake_followers(texels, segmentation.follows, at_vertices, masks);
  normalize_texels(texels, masks);
  fill_empty_texels(texels, masks);
  return assemble(names, at_vertices, std::move(masks));
}

RegionMasks whole_face(const Topology& topology, int size) {
  Image masks(size, size, {"whole"});
  std::fill(masks.pixels().begin(), masks.pixels().end(), 1.0F);
  return assemble({"whole"}, Eigen::MatrixXf::Ones(topology.vertex_count(), 1), std::move(masks));
}

RegionMasks painted_masks(const Topology& topology, const Image& paint) {
  const auto shared = Topology::make(topology.data());
  const TextureSpace texels(shared, paint.width(), paint.height());
  const UvCharts charts = uv_charts(texels, Points::Zero(topology.vertex_count(), 3));
  Image masks = paint;
  normalize_texels(texels, masks);
  Eigen::MatrixXf at_vertices = vertex_means(topology, sample_at_uvs(texels, charts, masks), {});
  for (Eigen::Index v = 0; v < at_vertices.rows(); ++v) {
    Eigen::RowVectorXf row = at_vertices.row(v);
    if (!normalize(row)) row.setConstant(1.0F / static_cast<float>(row.size()));
    at_vertices.row(v) = row;
  }
  fill_empty_texels(texels, masks);
  return assemble(paint.channel_names(), at_vertices, std::move(masks));
}

void divide_face(Actor& actor, const SegmentationOptions& segmentation, const MaskOptions& masks) {
  RegionMasks result = segmentation.regions == 1 ? whole_face(*actor.topology)
                                                 : region_masks(actor, segment(actor, segmentation), masks);
  actor.regions = std::move(result.regions);
  actor.region_masks = std::move(result.masks);
}

}  // namespace vultus::rig
