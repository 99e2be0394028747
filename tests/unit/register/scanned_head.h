#pragma once

#include <cmath>
#include <vector>

#include "core/random.h"
#include "core/rays.h"
#include "register/landmarks.h"
#include "register/subdivide.h"
#include "register/template_head.h"

namespace vultus::registration::test {

/// Somebody's head in the shipped topology, its scan and its landmarks, all in the scan's frame, mm.
struct ScannedHead {
  Template head = template_head();
  LoopSubdivision loop{head.topology, head.subdivisions};
  Points control;           ///< control vertices
  Points truth;             ///< refined vertices
  Mesh scan;                ///< from a cylinder around the face, own jittered grid with triangles of some 3 mm
  ScanLandmarks landmarks;  ///< the major ones, placed by hand (confidence 1), 0.3 mm off
};

inline Mesh cylinder_scan(const Topology& topology, const Points& shape, std::uint64_t seed) {
  const RayScene rays(topology, shape);
  Random random(seed);
  constexpr int rows = 90, columns = 130;
  std::vector<int> number(rows * columns, -1);
  Points points(rows * columns, 3);
  int seen = 0;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const double y = -120.0 + 230.0 * (i + random.uniform(-0.3, 0.3)) / rows;
      const double phi = -2.0 + 4.0 * (j + random.uniform(-0.3, 0.3)) / columns;
      const Eigen::Vector3d out(std::sin(phi), 0, std::cos(phi)), axis(0, y, -70.0);
      const auto hit = rays.hit(axis + 250.0 * out, -out, 0.0, 245.0);
      if (!hit) continue;
      number[i * columns + j] = seen;
      points.row(seen++) = (axis + (250.0 - hit->distance) * out).transpose();
    }
  std::vector<Eigen::RowVector3i> triangles;
  const auto add = [&](int a, int b, int c) {
    if (a < 0 || b < 0 || c < 0) return;
    for (const auto& [p, q] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
      if ((points.row(p) - points.row(q)).norm() > 10.0) return;
    triangles.emplace_back(a, b, c);
  };
  for (int i = 0; i + 1 < rows; ++i)
    for (int j = 0; j + 1 < columns; ++j) {
      const int a = number[i * columns + j], b = number[i * columns + j + 1];
      const int c = number[(i + 1) * columns + j], d = number[(i + 1) * columns + j + 1];
      add(a, b, d);
      add(a, d, c);
    }
  Triangles all(triangles.size(), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t) all.row(t) = triangles[t];
  Mesh scan;
  scan.topology = Topology::from_triangles(seen, all);
  scan.positions = points.topRows(seen);
  return scan;
}

/// `wide` and `long_faced` are factors on the template's shape.
inline ScannedHead scanned_head(double wide, double long_faced, std::uint64_t seed) {
  ScannedHead person;
  person.control = person.head.neutral;
  for (auto p : person.control.rowwise())
    p = Eigen::RowVector3d(wide * p.x() + 1.0 * std::sin(p.y() / 30.0),
                           long_faced * p.y() + 1.5 * std::sin(p.z() / 40.0),
                           1.02 * p.z() + 1.5 * std::cos(p.x() / 35.0));
  person.truth = person.loop(person.control);
  person.scan = cylinder_scan(*person.loop.refined(), person.truth, seed);
  Random random(seed + 1);
  for (const Landmark& landmark : person.head.landmarks) {
    if (!landmark.major) continue;
    Eigen::Vector3d position = person.truth.row(landmark.vertex).transpose();
    for (int k = 0; k < 3; ++k) position[k] += 0.3 * random.normal();
    person.landmarks.push_back({landmark.name, position, 1.0});
  }
  return person;
}

}  // namespace vultus::registration::test
