#include "register/unfold.h"

#include <Eigen/Geometry>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/neighbours.h"
#include "register/untangle.h"

namespace vultus::registration {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

bool none(const std::vector<bool>& flags) { return std::find(flags.begin(), flags.end(), true) == flags.end(); }

std::vector<bool> corners_of(const Topology& topology, const std::vector<bool>& triangles) {
  std::vector<bool> corners(topology.vertex_count(), false);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; triangles[t] && k < 3; ++k) corners[topology.triangles()(static_cast<int>(t), k)] = true;
  return corners;
}

void grow(const Topology& topology, int rings, std::vector<bool>& vertices) {
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<bool> touching(topology.triangles().rows(), false);
    for (std::size_t t = 0; t < touching.size(); ++t)
      for (int k = 0; k < 3; ++k) touching[t] = touching[t] || vertices[topology.triangles()(static_cast<int>(t), k)];
    vertices = corners_of(topology, touching);
  }
}

// Vertices that may move in one round: `core` is shaped anew, the free ones around it give way.
struct Pieces {
  std::vector<bool> core;
  std::vector<int> vertices;  // free
  std::vector<int> row;       // of each vertex among the free ones; -1: held
  std::vector<int> piece;     // of each free vertex
  int count = 0;
};

Pieces around(const Topology& topology, const std::vector<bool>& folded, const std::vector<bool>& border, int rings) {
  Pieces pieces;
  pieces.core = corners_of(topology, folded);
  grow(topology, rings, pieces.core);
  std::vector<bool> free = pieces.core;
  grow(topology, rings + 1, free);
  pieces.row.assign(free.size(), -1);
  for (std::size_t v = 0; v < free.size(); ++v)
    if (free[v] && !border[v]) {
      pieces.row[v] = static_cast<int>(pieces.vertices.size());
      pieces.vertices.push_back(static_cast<int>(v));
    }
  const Adjacency neighbours = adjacency(topology);
  pieces.piece.assign(pieces.vertices.size(), -1);
  for (std::size_t start = 0; start < pieces.vertices.size(); ++start) {
    if (pieces.piece[start] >= 0) continue;
    std::vector<int> open{static_cast<int>(start)};
    pieces.piece[start] = pieces.count;
    while (!open.empty()) {
      const int at = open.back();
      open.pop_back();
      for (const int next : neighbours.of(pieces.vertices[at])) {
        const int row = pieces.row[next];
        if (row < 0 || pieces.piece[row] >= 0) continue;
        pieces.piece[row] = pieces.count;
        open.push_back(row);
      }
    }
    ++pieces.count;
  }
  return pieces;
}

enum class Weights { mean_value, even };

// Row i: weights by which the free vertex i is the mean of its neighbours, in a plane or, where the reference is too
// crumpled to tell, evenly.
Eigen::SparseMatrix<double, Eigen::RowMajor> mean_weights(const Topology& topology, const Points& reference,
                                                          const Pieces& pieces, Weights kind) {
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> sums(pieces.vertices.size(), 0.0);
  const Triangles& triangles = topology.triangles();
  for (int t = 0; t < triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int row = pieces.row[triangles(t, k)];
      if (row < 0) continue;
      const int a = triangles(t, (k + 1) % 3), b = triangles(t, (k + 2) % 3);
      const Eigen::Vector3d to_a = reference.row(a) - reference.row(triangles(t, k)),
                            to_b = reference.row(b) - reference.row(triangles(t, k));
      const double half = std::tan(0.5 * std::atan2(to_a.cross(to_b).norm(), to_a.dot(to_b)));
      for (const auto& [vertex, length] : {std::pair(a, to_a.norm()), std::pair(b, to_b.norm())}) {
        // Bounds keep a reference with slivers from giving a neighbour all or nothing.
        const double weight = kind == Weights::even ? 1.0 : std::clamp(half, 1e-3, 1e3) / std::max(1e-6, length);
        entries.emplace_back(row, vertex, weight);
        sums[row] += weight;
      }
    }
  Eigen::SparseMatrix<double, Eigen::RowMajor> weights(static_cast<int>(pieces.vertices.size()),
                                                       topology.vertex_count());
  weights.setFromTriplets(entries.begin(), entries.end());
  for (std::size_t row = 0; row < sums.size(); ++row) weights.row(static_cast<int>(row)) /= std::max(1e-12, sums[row]);
  return weights;
}

// The equation x − mean of neighbours = bend over the free vertices, held ones given.
class Relaxation {
 public:
  Relaxation(const Topology& topology, const Points& reference, const Points& positions, const Pieces& pieces,
             Weights kind)
      : topology_(topology),
        positions_(positions),
        pieces_(pieces),
        weights_(mean_weights(topology, reference, pieces, kind)) {
    const int n = static_cast<int>(pieces.vertices.size());
    std::vector<Eigen::Triplet<double>> entries;
    held_ = Points::Zero(n, 3);
    for (int row = 0; row < n; ++row) {
      entries.emplace_back(row, row, 1.0);
      for (decltype(weights_)::InnerIterator it(weights_, row); it; ++it) {
        const int column = pieces.row[it.col()];
        if (column >= 0)
          entries.emplace_back(row, column, -it.value());
        else
          held_.row(row) += it.value() * positions.row(it.col());
      }
    }
    Sparse matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    solver_.compute(matrix);
    const Points normals = vertex_normals(topology, reference)(pieces.vertices, Eigen::all);
    const Points bend = reference(pieces.vertices, Eigen::all) - weights_ * reference;
    curvature_ = bend.cwiseProduct(normals).rowwise().sum();
    own_bend_ = positions(pieces.vertices, Eigen::all) - weights_ * positions;
  }

  bool solvable() const { return solver_.info() == Eigen::Success; }

  // The core takes `share` of the reference's curvature along `normals` (vertex_count×3); what is around it keeps its
  // own.
  Points solved(double share, const Points& normals) const {
    Eigen::MatrixXd right = held_;
    for (std::size_t row = 0; row < pieces_.vertices.size(); ++row) {
      const int i = static_cast<int>(row), v = pieces_.vertices[row];
      if (pieces_.core[v])
        right.row(i) += share * curvature_[i] * normals.row(v);
      else
        right.row(i) += own_bend_.row(i);
    }
    Points result = positions_;
    const Eigen::MatrixXd solution = solver_.solve(right);
    for (std::size_t row = 0; row < pieces_.vertices.size(); ++row)
      result.row(pieces_.vertices[row]) = solution.row(static_cast<int>(row));
    return result;
  }

  // Folded triangles of each piece.
  std::vector<int> folds(const std::vector<bool>& folded) const {
    std::vector<int> counts(pieces_.count, 0);
    for (std::size_t t = 0; t < folded.size(); ++t) {
      if (!folded[t]) continue;
      for (int k = 0; k < 3; ++k) {
        const int row = pieces_.row[topology_.triangles()(static_cast<int>(t), k)];
        if (row < 0) continue;
        ++counts[pieces_.piece[row]];
        break;
      }
    }
    return counts;
  }

 private:
  const Topology& topology_;
  const Points& positions_;
  const Pieces& pieces_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> weights_;
  Eigen::SparseLU<Sparse> solver_;
  Points held_, own_bend_;
  Eigen::VectorXd curvature_;
};

// Every piece with the largest share of its curvature that, once untangled, leaves the fewest folds, if they are fewer
// than before.
Points relaxed(const Topology& topology, const Points& reference, const Points& positions,
               const std::vector<bool>& folded, const std::vector<bool>& border, const Pieces& pieces) {
  std::vector<int> fewest(pieces.count, std::numeric_limits<int>::max());
  Points result = positions;
  auto take_better = [&](const Points& candidate, const std::vector<int>& folds) {
    for (std::size_t row = 0; row < pieces.vertices.size(); ++row) {
      const int piece = pieces.piece[row], v = pieces.vertices[row];
      if (folds[piece] < fewest[piece]) result.row(v) = candidate.row(v);
    }
    for (int p = 0; p < pieces.count; ++p) fewest[p] = std::min(fewest[p], folds[p]);
  };
  for (const Weights kind : {Weights::mean_value, Weights::even}) {
    const Relaxation relaxation(topology, reference, positions, pieces, kind);
    if (!relaxation.solvable()) continue;
    take_better(positions, relaxation.folds(folded));
    const Points normals = vertex_normals(topology, relaxation.solved(0.0, Points::Zero(positions.rows(), 3)));
    for (const double share : {1.0, 0.5, 0.25, 0.0}) {
      const Points candidate = untangled(topology, reference, relaxation.solved(share, normals), border);
      take_better(candidate, relaxation.folds(folded_triangles(topology, reference, candidate)));
      if (std::all_of(fewest.begin(), fewest.end(), [](int count) { return count == 0; })) return result;
    }
  }
  return result;
}

}  // namespace

std::vector<bool> turned_triangles(const Topology& topology, const Points& positions) {
  const Points faces = triangle_normals(topology, positions), corners = vertex_normals(topology, positions);
  std::vector<bool> turned(faces.rows());
  for (int t = 0; t < faces.rows(); ++t) {
    const auto c = topology.triangles().row(t);
    turned[t] = faces.row(t).dot(corners.row(c[0]) + corners.row(c[1]) + corners.row(c[2])) < 0.0;
  }
  return turned;
}

std::vector<bool> folded_triangles(const Topology& topology, const Points& reference, const Points& positions) {
  const std::vector<bool> before = turned_triangles(topology, reference);
  std::vector<bool> folded = turned_triangles(topology, positions);
  for (std::size_t t = 0; t < folded.size(); ++t) folded[t] = folded[t] && !before[t];
  return folded;
}

Points unfolded(const Topology& topology, const Points& reference, const Points& positions, int rounds) {
  Points result = positions;
  std::vector<bool> folded = folded_triangles(topology, reference, result);
  if (none(folded)) return result;
  const std::vector<bool> border = border_vertices(topology);
  result = untangled(topology, reference, result, border);
  folded = folded_triangles(topology, reference, result);
  constexpr int widest = 6;  // rings; then the folds that wider pieces brought are looked at closely again
  for (int round = 0; round < rounds && !none(folded); ++round) {
    const int rings = 1 + round % widest;
    result = relaxed(topology, reference, result, folded, border, around(topology, folded, border, rings));
    folded = folded_triangles(topology, reference, result);
  }
  return result;
}

}  // namespace vultus::registration
