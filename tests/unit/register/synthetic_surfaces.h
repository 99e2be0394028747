#pragma once

#include <cmath>
#include <vector>

#include "core/mesh.h"
#include "core/random.h"

namespace vultus::registration::test {

/// Closed-form test surface without symmetry: a ball of 90 mm with three bumps, seen along unit `d`.
inline double bumpy_radius(const Eigen::Vector3d& d) {
  double radius = 90.0;
  radius += 14.0 * std::exp(-8.0 * (d - Eigen::Vector3d(0, 0, 1)).squaredNorm());
  radius += 9.0 * std::exp(-10.0 * (d - Eigen::Vector3d(0.7, 0.5, 0.51).normalized()).squaredNorm());
  radius -= 8.0 * std::exp(-12.0 * (d - Eigen::Vector3d(-0.5, -0.6, 0.6).normalized()).squaredNorm());
  return radius;
}

/// Latitude-longitude grid over `radius(direction)` with jittered places and radial noise in mm, open at the poles.
template <typename Radius>
Mesh radial_grid(int rings, double noise, std::uint64_t seed, Radius radius) {
  const int around = 2 * rings;
  Random random(seed);
  Mesh mesh;
  mesh.positions.resize((rings + 1) * around, 3);
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j < around; ++j) {
      const double jitter = i == 0 || i == rings ? 0.0 : random.uniform(-0.3, 0.3);
      const double theta = 0.15 + (M_PI - 0.3) * (i + jitter) / rings;
      const double phi = 2 * M_PI * (j + random.uniform(-0.3, 0.3)) / around;
      const Eigen::Vector3d d(std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi));
      mesh.positions.row(i * around + j) = (radius(d) + noise * random.normal()) * d;
    }
  Triangles triangles(2 * rings * around, 3);
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < around; ++j) {
      const int a = i * around + j, b = i * around + (j + 1) % around, c = a + around, d = b + around;
      triangles.row(2 * (i * around + j)) << a, c, b;
      triangles.row(2 * (i * around + j) + 1) << b, c, d;
    }
  mesh.topology = Topology::from_triangles(static_cast<int>(mesh.positions.rows()), triangles);
  return mesh;
}

inline Mesh bumpy_sphere(int rings, double noise, std::uint64_t seed) {
  return radial_grid(rings, noise, seed, bumpy_radius);
}

/// `columns` × `rows` vertices at `place(column, row)`, row after row; seen from +z where columns run along x, rows
/// along y.
template <typename Place>
Mesh grid(int columns, int rows, Place place) {
  Mesh mesh;
  mesh.positions.resize(columns * rows, 3);
  Triangles triangles(2 * (columns - 1) * (rows - 1), 3);
  int t = 0;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const int a = r * columns + c;
      mesh.positions.row(a) = Eigen::Vector3d(place(c, r)).transpose();
      if (r + 1 == rows || c + 1 == columns) continue;
      triangles.row(t++) << a, a + 1, a + columns + 1;
      triangles.row(t++) << a, a + columns + 1, a + columns;
    }
  mesh.topology = Topology::from_triangles(columns * rows, triangles);
  return mesh;
}

inline std::vector<int> every(const Mesh& mesh, int stride) {
  std::vector<int> some;
  for (int v = 0; v < mesh.topology->vertex_count(); v += stride) some.push_back(v);
  return some;
}

}  // namespace vultus::registration::test
