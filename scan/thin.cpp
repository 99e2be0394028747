#include "scan/thin.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/error.h"

namespace vultus::scan {
namespace {

// Number of each vertex's cell; cells are numbered along x, then y, then z.
struct Cells {
  std::vector<int> of_vertex;
  int count = 0;
};

Cells cells_of(const Points& positions, double cell) {
  const Box box = bounds(positions);
  constexpr std::uint64_t most = (1u << 21) - 1;  // cells along an axis that a key has room for
  std::vector<std::pair<std::uint64_t, int>> keys(positions.rows());
  tbb::parallel_for(Eigen::Index{0}, positions.rows(), [&](Eigen::Index v) {
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double place = std::floor((positions(v, axis) - box.min[axis]) / cell);
      key = (key << 21) | std::min(most, static_cast<std::uint64_t>(place));
    }
    keys[v] = {key, static_cast<int>(v)};
  });
  tbb::parallel_sort(keys.begin(), keys.end());
  Cells cells{std::vector<int>(keys.size()), 0};
  for (std::size_t i = 0; i < keys.size(); ++i) {
    cells.count += i == 0 || keys[i].first != keys[i - 1].first;
    cells.of_vertex[keys[i].second] = cells.count - 1;
  }
  return cells;
}

Points means(const Points& rows, const Cells& cells) {
  Points sum = Points::Zero(cells.count, 3);
  Eigen::VectorXd number = Eigen::VectorXd::Zero(cells.count);
  for (Eigen::Index v = 0; v < rows.rows(); ++v) {
    sum.row(cells.of_vertex[v]) += rows.row(v);
    number[cells.of_vertex[v]] += 1.0;
  }
  return sum.array().colwise() / number.array();
}

// Triangles whose corners lie in three cells, each once, lowest cell first.
std::vector<std::array<int, 3>> triangles_between(const Triangles& triangles, const Cells& cells) {
  std::vector<std::array<int, 3>> kept;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    std::array<int, 3> corners{};
    for (int k = 0; k < 3; ++k) corners[k] = cells.of_vertex[triangles(t, k)];
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    kept.push_back(corners);
  }
  tbb::parallel_sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  return kept;
}

}  // namespace

Mesh thinned(const Mesh& scan, double cell) {
  if (!(cell > 0.0)) throw InputError("thinning: the cell must be positive");
  if (scan.positions.rows() == 0) return scan;
  if (!scan.positions.allFinite()) throw InputError("thinning: the mesh has vertices that are not finite");
  const Cells cells = cells_of(scan.positions, cell);
  TopologyData data;
  data.vertex_count = cells.count;
  data.face_offsets.push_back(0);
  for (const auto& corners : triangles_between(scan.topology->triangles(), cells)) {
    data.corner_vertex.insert(data.corner_vertex.end(), corners.begin(), corners.end());
    data.face_offsets.push_back(static_cast<int>(data.corner_vertex.size()));
  }
  Mesh thin;
  thin.topology = Topology::make(std::move(data));
  thin.positions = means(scan.positions, cells);
  if (scan.has_colours()) thin.colours = means(scan.colours, cells);
  return thin;
}

}  // namespace vultus::scan
