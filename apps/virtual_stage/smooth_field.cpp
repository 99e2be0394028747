#include "apps/virtual_stage/smooth_field.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace vultus::virtual_stage {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

struct Operator {
  Sparse laplacian;      // positive semidefinite
  Eigen::VectorXd area;  // of each vertex's share, mm²
};

Operator cotangent_laplacian(const Topology& topology, const Points& positions) {
  const int n = topology.vertex_count();
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd area = Eigen::VectorXd::Constant(n, 1e-6);
  for (Eigen::Index t = 0; t < topology.triangles().rows(); ++t)
    for (int c = 0; c < 3; ++c) {
      const int apex = topology.triangles()(t, c), i = topology.triangles()(t, (c + 1) % 3),
                j = topology.triangles()(t, (c + 2) % 3);
      const Eigen::Vector3d a = positions.row(i) - positions.row(apex), b = positions.row(j) - positions.row(apex);
      const double doubled = a.cross(b).norm();
      area[apex] += doubled / 6.0;
      const double weight =
          std::clamp(0.5 * a.dot(b) / std::max(doubled, 1e-9), 0.02, 20.0);  // stays convex on slivers
      entries.insert(entries.end(), {{i, i, weight}, {j, j, weight}, {i, j, -weight}, {j, i, -weight}});
    }
  Operator op{Sparse(n, n), area};
  op.laplacian.setFromTriplets(entries.begin(), entries.end());
  return op;
}

}  // namespace

SmoothFields::SmoothFields(const Topology& topology, const Points& positions) {
  const Operator op = cotangent_laplacian(topology, positions);
  const Sparse scaled = op.area.cwiseInverse().asDiagonal() * op.laplacian;
  energy_ = op.laplacian.transpose() * scaled;
}

Eigen::VectorXd SmoothFields::through(const std::vector<std::pair<int, double>>& given) const {
  const int n = static_cast<int>(energy_.rows());
  Eigen::VectorXd values = Eigen::VectorXd::Zero(n);
  std::vector<int> row(n, 0);
  for (const auto& [vertex, value] : given) {
    values[vertex] = value;
    row[vertex] = -1;
  }
  int unknowns = 0;
  for (int v = 0; v < n; ++v)
    if (row[v] == 0) row[v] = unknowns++;

  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
  constexpr double towards_zero = 1e-10;  // decides parts without a given value, nothing else
  for (int column = 0; column < n; ++column)
    for (Sparse::InnerIterator it(energy_, column); it; ++it) {
      const int r = row[it.row()];
      if (r < 0) continue;
      if (row[column] < 0)
        right[r] -= it.value() * values[column];
      else
        entries.emplace_back(r, row[column], it.value() + (it.row() == column ? towards_zero : 0.0));
    }
  Sparse system(unknowns, unknowns);
  system.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Sparse> solver(system);
  if (solver.info() != Eigen::Success) throw InputError("face model: degenerate triangles");
  const Eigen::VectorXd solution = solver.solve(right);
  for (int v = 0; v < n; ++v)
    if (row[v] >= 0) values[v] = solution[row[v]];
  return values;
}

}  // namespace vultus::virtual_stage
