#include "retarget/marker_weights.h"

#include <limits>
#include <numeric>

#include <tbb/parallel_for.h>

#include "core/error.h"
#include "core/texture_space.h"

namespace vultus::retarget {
namespace {

/// Number of the UV chart of each triangle: triangles that share a row of `uvs` share a chart.
std::vector<int> charts_of(const Topology& topology) {
  std::vector<int> parent(topology.uvs().rows());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int row) {
    while (parent[row] != row) row = parent[row] = parent[parent[row]];
    return row;
  };
  const Triangles& uvs = topology.triangle_uvs();
  for (Eigen::Index t = 0; t < uvs.rows(); ++t) {
    for (int corner = 1; corner < 3; ++corner) {
      const int a = root(uvs(t, 0)), b = root(uvs(t, corner));
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
  std::vector<int> chart(uvs.rows());
  for (Eigen::Index t = 0; t < uvs.rows(); ++t) chart[t] = root(uvs(t, 0));
  return chart;
}

std::vector<bool> triangles_in(const Topology& topology, const std::string& set) {
  const Triangles& triangles = topology.triangles();
  std::vector<bool> inside(triangles.rows(), !topology.has_set(set));
  if (!topology.has_set(set)) return inside;
  std::vector<bool> vertex(topology.vertex_count(), false);
  for (int v : topology.set(set)) vertex[v] = true;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    inside[t] = vertex[triangles(t, 0)] && vertex[triangles(t, 1)] && vertex[triangles(t, 2)];
  }
  return inside;
}

/// The marker each texel belongs to, or -1.
std::vector<int> cells(const TextureSpace& space, const std::vector<SurfacePoint>& places, const std::string& face_set) {
  const std::vector<int> chart = charts_of(space.topology());
  const std::vector<bool> inside = triangles_in(space.topology(), face_set);
  Uvs marker_uv(static_cast<Eigen::Index>(places.size()), 2);
  for (std::size_t q = 0; q < places.size(); ++q) {
    marker_uv.row(static_cast<Eigen::Index>(q)) = space.uv(places[q]).transpose();
  }
  std::vector<int> owner(static_cast<std::size_t>(space.width()) * space.height(), -1);
  tbb::parallel_for(0, space.height(), [&](int y) {
    for (int x = 0; x < space.width(); ++x) {
      const SurfacePoint& texel = space.at(x, y);
      if (!texel.valid() || !inside[texel.triangle]) continue;
      const Eigen::RowVector2d uv((x + 0.5) / space.width(), 1.0 - (y + 0.5) / space.height());
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t q = 0; q < places.size(); ++q) {
        if (chart[places[q].triangle] != chart[texel.triangle]) continue;
        const double distance = (marker_uv.row(static_cast<Eigen::Index>(q)) - uv).squaredNorm();
        if (distance < nearest) {
          nearest = distance;
          owner[static_cast<std::size_t>(y) * space.width() + x] = static_cast<int>(q);
        }
      }
    }
  });
  return owner;
}

/// The masks at a place, from the vertices of its triangle.
Eigen::RowVectorXd masks_at(const rig::Actor& actor, const SurfacePoint& place) {
  Eigen::RowVectorXd masks = Eigen::RowVectorXd::Zero(static_cast<Eigen::Index>(actor.regions.size()));
  for (Eigen::Index k = 0; k < masks.size(); ++k) {
    for (int corner = 0; corner < 3; ++corner) {
      const int vertex = actor.topology->triangles()(place.triangle, corner);
      masks[k] += place.barycentric[corner] * actor.regions[k].vertex_mask[vertex];
    }
  }
  return masks;
}

Image baked_masks(const rig::Actor& actor, const TextureSpace& space) {
  Eigen::MatrixXf masks(actor.topology->vertex_count(), static_cast<Eigen::Index>(actor.regions.size()));
  std::vector<std::string> names;
  for (std::size_t k = 0; k < actor.regions.size(); ++k) {
    masks.col(static_cast<Eigen::Index>(k)) = actor.regions[k].vertex_mask;
    names.push_back(actor.regions[k].name);
  }
  return space.bake(masks, names);
}

Eigen::MatrixXd sums_over_cells(const std::vector<int>& owner, const Image& masks, std::size_t markers) {
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(markers), masks.channels());
  for (int y = 0; y < masks.height(); ++y) {
    for (int x = 0; x < masks.width(); ++x) {
      const int q = owner[static_cast<std::size_t>(y) * masks.width() + x];
      if (q < 0) continue;
      for (int k = 0; k < masks.channels(); ++k) sums(q, k) += std::max(masks.at(x, y)[k], 0.0f);
    }
  }
  return sums;
}

}  // namespace

MarkerWeights MarkerWeights::global(std::vector<std::string> labels) {
  const auto count = static_cast<Eigen::Index>(labels.size());
  return {std::move(labels), {"whole"}, Eigen::MatrixXd::Ones(count, 1), {}};
}

MarkerWeights marker_weights(const rig::Actor& actor, const std::vector<std::string>& labels,
                             const std::vector<SurfacePoint>& places, const CellOptions& options) {
  if (labels.size() != places.size()) throw InputError("marker weights: one place a label is needed");
  if (options.size < 16) throw InputError("marker weights: the map must be at least 16 texels wide");
  for (std::size_t q = 0; q < places.size(); ++q) {
    if (!places[q].valid() || places[q].triangle >= actor.topology->triangles().rows()) {
      throw InputError("marker weights: " + labels[q] + " has no place on the actor's topology");
    }
  }
  if (actor.regions.empty()) return MarkerWeights::global(labels);
  const bool own_masks = actor.region_masks.channels() == static_cast<int>(actor.regions.size());
  const TextureSpace space(actor.topology, own_masks ? actor.region_masks.width() : options.size,
                           own_masks ? actor.region_masks.height() : options.size);
  const std::vector<int> owner = cells(space, places, options.face_set);
  MarkerWeights weights{labels, {}, {}, {}};
  for (const rig::Region& region : actor.regions) weights.regions.push_back(region.name);
  // The mean over a cell and the sum differ by a factor a row, which the normalization over regions removes.
  weights.values = sums_over_cells(owner, own_masks ? actor.region_masks : baked_masks(actor, space), labels.size());
  for (std::size_t q = 0; q < labels.size(); ++q) {
    auto row = weights.values.row(static_cast<Eigen::Index>(q));
    if (row.sum() <= 0.0) {
      weights.notes.push_back("marker " + labels[q] + ": its texture cell holds no texel; masks taken at its place");
      row = masks_at(actor, places[q]);
    }
    if (row.sum() <= 0.0) throw InputError("marker weights: " + labels[q] + " lies outside every region");
    row /= row.sum();
  }
  return weights;
}

}  // namespace vultus::retarget
