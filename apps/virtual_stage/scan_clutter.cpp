#include "apps/virtual_stage/scan_clutter.h"

#include <Eigen/Geometry>
#include <cmath>

namespace vultus::virtual_stage {
namespace {

// Loose triangles with a colour a vertex, all in the scan frame.
struct Pieces {
  std::vector<Eigen::Vector3d> positions, colours;
  std::vector<Eigen::Vector3i> triangles;

  int add(const Eigen::Vector3d& position, const Eigen::Vector3d& colour) {
    positions.push_back(position);
    colours.push_back(colour);
    return static_cast<int>(positions.size()) - 1;
  }
};

Eigen::Vector3d scatter(Random& random, double deviation) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return deviation * Eigen::Vector3d(x, y, z);
}

// A bent ribbon, as a scanner sees a lock of hair.
void add_strand(Pieces& pieces, const Eigen::Vector3d& root, const Eigen::Vector3d& normal, Random& random) {
  Eigen::Vector3d direction = (normal + scatter(random, 0.6)).normalized();
  Eigen::Vector3d across = direction.cross(scatter(random, 1.0)).normalized();
  const Eigen::Vector3d colour = Eigen::Vector3d(0.05, 0.035, 0.025) * random.uniform(0.6, 1.6);
  const int segments = 3 + random.below(6);
  const double width = random.uniform(0.4, 1.2);
  Eigen::Vector3d at = root;
  int previous = -1;
  for (int s = 0; s <= segments; ++s) {
    const double taper = width * (1.0 - 0.8 * s / segments);
    const int left = pieces.add(at - taper * across, colour);
    pieces.add(at + taper * across + scatter(random, 0.1), colour);
    if (previous >= 0) {
      pieces.triangles.emplace_back(previous, previous + 1, left + 1);
      pieces.triangles.emplace_back(previous, left + 1, left);
    }
    previous = left;
    at += random.uniform(1.5, 3.0) * direction;
    direction = (direction + Eigen::Vector3d(0, -0.15, 0) + scatter(random, 0.25)).normalized();
  }
}

// A ragged, noisy patch of a cylinder: `axis` and `radius` of the thing it was part of.
void add_patch(Pieces& pieces, const Eigen::Vector3d& base, const Eigen::Vector3d& axis, const Eigen::Vector3d& out,
               double radius, double length, const Eigen::Vector3d& colour, Random& random) {
  constexpr int around = 14;
  const int along = static_cast<int>(length / 3.0);
  const Eigen::Vector3d side = axis.cross(out).normalized();
  const int first = static_cast<int>(pieces.positions.size());
  for (int a = 0; a <= along; ++a)
    for (int b = 0; b <= around; ++b) {
      const double angle = 1.6 * (static_cast<double>(b) / around - 0.5);
      const Eigen::Vector3d on = base + 3.0 * a * axis + radius * (std::cos(angle) * out + std::sin(angle) * side);
      pieces.add(on + scatter(random, 0.3), colour * random.uniform(0.9, 1.1));
    }
  for (int a = 0; a < along; ++a)
    for (int b = 0; b < around; ++b) {
      if (random.uniform() < 0.25) continue;
      const int v = first + a * (around + 1) + b;
      pieces.triangles.emplace_back(v, v + 1, v + around + 2);
      pieces.triangles.emplace_back(v, v + around + 2, v + around + 1);
    }
}

void add_flying_points(Pieces& pieces, const Box& box, Random& random) {
  for (int i = 0; i < 60; ++i) {
    const double x = random.uniform(-0.2, 1.2), y = random.uniform(-0.2, 1.2), z = random.uniform(-0.2, 1.2);
    const Eigen::Vector3d at = box.min + Eigen::Vector3d(x, y, z).cwiseProduct(box.max - box.min);
    const int corners = 3 + random.below(4);
    const Eigen::Vector3d colour = Eigen::Vector3d::Constant(random.uniform(0.05, 0.7));
    const int first = pieces.add(at, colour);
    for (int c = 0; c < corners; ++c) pieces.add(at + scatter(random, 0.7), colour);
    for (int c = 0; c + 1 < corners; ++c) pieces.triangles.emplace_back(first, first + 1 + c, first + 2 + c);
  }
}

void append(Scan& scan, const Pieces& pieces) {
  const int old_vertices = scan.mesh.topology->vertex_count();
  const Triangles& old_triangles = scan.mesh.topology->triangles();
  const int vertices = old_vertices + static_cast<int>(pieces.positions.size());
  Triangles triangles(old_triangles.rows() + pieces.triangles.size(), 3);
  triangles.topRows(old_triangles.rows()) = old_triangles;
  for (std::size_t t = 0; t < pieces.triangles.size(); ++t)
    triangles.row(old_triangles.rows() + t) = (pieces.triangles[t].array() + old_vertices).matrix().transpose();
  scan.mesh.positions.conservativeResize(vertices, 3);
  const bool coloured = scan.mesh.colours.rows() == old_vertices;
  if (coloured) scan.mesh.colours.conservativeResize(vertices, 3);
  for (std::size_t v = 0; v < pieces.positions.size(); ++v) {
    scan.mesh.positions.row(old_vertices + v) = pieces.positions[v].transpose();
    if (coloured) scan.mesh.colours.row(old_vertices + v) = pieces.colours[v].cwiseMin(1.0).transpose();
  }
  scan.mesh.topology = Topology::from_triangles(vertices, triangles);
  scan.truth.resize(vertices);
}

}  // namespace

void add_clutter(Scan& scan, const ScanSubject& subject, Random& random) {
  Pieces pieces;
  const Similarity& pose = scan.scan_from_face;
  if (subject.hair.size() > 0) {
    const Points normals = vertex_normals(*subject.surface.topology, subject.surface.positions);
    std::vector<int> rooted;
    for (Eigen::Index v = 0; v < subject.hair.size(); ++v)
      if (subject.hair[v] > 0.3) rooted.push_back(static_cast<int>(v));
    for (int strand = 0; strand < 300 && !rooted.empty(); ++strand) {
      const int v = rooted[random.below(static_cast<int>(rooted.size()))];
      add_strand(pieces, pose * Eigen::Vector3d(subject.surface.positions.row(v)),
                 pose.rotation * Eigen::Vector3d(normals.row(v)), random);
    }
  }
  const Box box = bounds(scan.mesh.positions);
  const Eigen::Vector3d size = box.max - box.min;
  const Eigen::Vector3d cloth(0.16, 0.17, 0.2), metal(0.45, 0.45, 0.47);
  for (const double side : {-1.0, 1.0}) {
    const Eigen::Vector3d base(box.centre().x() + 0.55 * side * size.x(), box.min.y() - random.uniform(5, 20),
                               box.min.z() + 0.3 * size.z());
    add_patch(pieces, base, Eigen::Vector3d(side, -0.25, 0.1).normalized(),
              Eigen::Vector3d(0.25 * side, 1, 0).normalized(), random.uniform(25, 40), random.uniform(40, 80), cloth,
              random);
  }
  const Eigen::Vector3d stand(box.centre().x() + random.uniform(-40, 40), box.min.y(),
                              box.min.z() - random.uniform(40, 90));
  add_patch(pieces, stand, Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ(), 12, random.uniform(60, 160), metal,
            random);
  add_flying_points(pieces, box, random);
  append(scan, pieces);
}

}  // namespace vultus::virtual_stage
