#include "register/fill.h"

#include <tbb/parallel_for.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include "core/error.h"
#include "core/neighbours.h"
#include "core/rays.h"
#include "core/transform.h"

namespace vultus::registration {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

}  // namespace

Points fill_smoothly(const Topology& topology, const Points& positions, const Points& displacements,
                     const std::vector<bool>& known) {
  const std::vector<int> component = components(topology);
  std::vector<bool> reached(component.size(), false);
  for (std::size_t v = 0; v < known.size(); ++v)
    if (known[v]) reached[component[v]] = true;
  std::vector<int> unknown_row(known.size(), -1);
  int rows = 0;
  for (std::size_t v = 0; v < known.size(); ++v)
    if (!known[v] && reached[component[v]]) unknown_row[v] = rows++;
  if (rows == 0) return displacements;

  std::vector<Eigen::Triplet<double>> entries;
  Points right = Points::Zero(rows, 3);
  for (const auto& [a, b] : edges(topology)) {
    const double weight = 1.0 / std::max(1e-3, (positions.row(a) - positions.row(b)).norm());
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
      const int row = unknown_row[from];
      if (row < 0) continue;
      entries.emplace_back(row, row, weight);
      if (unknown_row[to] >= 0)
        entries.emplace_back(row, unknown_row[to], -weight);
      else
        right.row(row) += weight * displacements.row(to);
    }
  }
  Sparse laplacian(rows, rows);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Sparse> solver(laplacian);
  const Points solution = solver.solve(right);
  Points filled = displacements;
  for (std::size_t v = 0; v < known.size(); ++v)
    if (unknown_row[v] >= 0) filled.row(v) = solution.row(unknown_row[v]);
  return filled;
}

Points fit_smoothly(const Topology& topology, const Points& displacements, const Eigen::VectorXd& weights,
                    double stiffness) {
  std::vector<Eigen::Triplet<double>> entries;
  const int n = topology.vertex_count();
  // The tiny diagonal holds components without data where they are.
  for (int v = 0; v < n; ++v) entries.emplace_back(v, v, weights[v] + 1e-9);
  for (const auto& [a, b] : edges(topology)) {
    entries.emplace_back(a, a, stiffness);
    entries.emplace_back(b, b, stiffness);
    entries.emplace_back(a, b, -stiffness);
    entries.emplace_back(b, a, -stiffness);
  }
  Sparse matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Sparse> solver(matrix);
  return solver.solve(weights.asDiagonal() * displacements);
}

std::vector<bool> fitted_vertices(const Topology& topology) {
  constexpr std::array<const char*, 11> inner = {"eyeball",   "eye_socket", "eye_blend",   "eye_occlusion",
                                                 "eyelashes", "lacrimal",   "inner_mouth", "mouth_cavity",
                                                 "teeth",     "gums",       "tongue"};
  std::vector<bool> fitted(topology.vertex_count(), true);
  for (const auto& [name, vertices] : topology.sets()) {
    if (std::none_of(inner.begin(), inner.end(), [&](const char* prefix) { return name.starts_with(prefix); }))
      continue;
    for (const int v : vertices) fitted[v] = false;
  }
  return fitted;
}

std::vector<bool> exposed_vertices(const Topology& topology, const Points& positions, double least_open) {
  const RayScene scene(topology, positions);
  const Points normals = vertex_normals(topology, positions);
  const std::vector<bool> fitted = fitted_vertices(topology);
  constexpr int directions = 96;
  const double golden = M_PI * (3.0 - std::sqrt(5.0));
  std::vector<char> exposed(fitted.size(), 0);
  tbb::parallel_for(std::size_t{0}, fitted.size(), [&](std::size_t v) {
    if (!fitted[v]) return;
    const Eigen::Vector3d normal = normals.row(v);
    const Eigen::Vector3d origin = positions.row(v).transpose() + 0.2 * normal;
    double open = 0.0, all = 0.0;
    for (int k = 0; k < directions; ++k) {  // evenly over the sphere (a golden spiral)
      const double z = 1.0 - (2.0 * k + 1.0) / directions, r = std::sqrt(1.0 - z * z);
      const Eigen::Vector3d direction(r * std::cos(golden * k), r * std::sin(golden * k), z);
      const double cosine = direction.dot(normal);
      if (cosine <= 0.05) continue;
      all += cosine;
      if (!scene.occluded(origin, direction, 0.0, 60.0)) open += cosine;
    }
    exposed[v] = all > 0.0 && open >= least_open * all;
  });
  return std::vector<bool>(exposed.begin(), exposed.end());
}

namespace {

std::vector<bool> vertices_of_sets(const Topology& topology, const std::string& prefix) {
  std::vector<bool> inside(topology.vertex_count(), false);
  for (const auto& [name, vertices] : topology.sets())
    if (name.starts_with(prefix))
      for (int v : vertices) inside[v] = true;
  return inside;
}

}  // namespace

void carry_components(const Topology& topology, const Points& rest, const std::vector<bool>& fitted, bool free_scale,
                      Points& moved) {
  const std::vector<int> component = components(topology);
  std::map<int, std::vector<int>> bodies;
  std::vector<int> skin;
  std::vector<bool> touched(component.size(), false);
  for (int v = 0; v < topology.vertex_count(); ++v)
    if (fitted[v]) {
      touched[component[v]] = true;
      skin.push_back(v);
    }
  for (int v = 0; v < topology.vertex_count(); ++v)
    if (!touched[component[v]]) bodies[component[v]].push_back(v);
  if (bodies.empty() || skin.size() < 8) return;

  const std::vector<bool> in_eye = vertices_of_sets(topology, "eye");
  const PointTree tree(rest(skin, Eigen::all));
  for (const auto& [number, vertices] : bodies) {
    const Points body = rest(vertices, Eigen::all);
    const Eigen::Vector3d centre = body.colwise().mean().transpose();
    // Lids slide over an eyeball that stays in its socket: the skin beyond them tells where that is.
    const double radius = (body.rowwise() - centre.transpose()).rowwise().norm().maxCoeff();
    const double nearest = in_eye[vertices.front()] ? 1.4 * radius : 0.0;
    std::vector<int> around;
    for (const auto& neighbour : tree.nearest(centre, static_cast<int>(skin.size()))) {
      if (neighbour.distance >= nearest) around.push_back(skin[neighbour.index]);
      if (around.size() == 200) break;
    }
    const Points source = rest(around, Eigen::all), target = moved(around, Eigen::all);
    const RobustFit fit = fit_similarity_robust(source, target, free_scale ? Scaling::free : Scaling::fixed, 0.5);
    const Points placed = transformed(fit.target_from_source, body);
    for (std::size_t i = 0; i < vertices.size(); ++i) moved.row(vertices[i]) = placed.row(i);
  }
}

}  // namespace vultus::registration
