#include "rig/resample.h"

#include <tbb/parallel_for.h>

#include <Eigen/SparseCholesky>
#include <memory>

#include "core/error.h"
#include "core/neighbours.h"
#include "core/rays.h"
#include "core/rbf.h"
#include "rig/attachments.h"
#include "rig/geodesic.h"

namespace vultus::rig {
namespace {

constexpr int kFewestLandmarks = 8;
constexpr double kSameWay = 0.3;  // cosine between normals of corresponding surfaces

RbfMap surface_from_mesh(const Points& mesh_neutral, const registration::Ibug68& mesh_points,
                         const Points& surface_neutral, const registration::Ibug68& surface_points) {
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t i = 0; i < mesh_points.size(); ++i) {
    if (mesh_points[i] < 0 || surface_points[i] < 0) continue;
    bool fresh = true;  // schemes may name one vertex twice
    for (const auto& [m, s] : pairs)
      fresh = fresh && (mesh_neutral.row(m) - mesh_neutral.row(mesh_points[i])).norm() > 1e-6;
    if (fresh) pairs.emplace_back(mesh_points[i], surface_points[i]);
  }
  if (static_cast<int>(pairs.size()) < kFewestLandmarks)
    throw InputError("motion transfer: the faces share only " + std::to_string(pairs.size()) +
                     " landmarks of the 68-point scheme; at least " + std::to_string(kFewestLandmarks) +
                     " are needed between different topologies");
  Points source(static_cast<Eigen::Index>(pairs.size()), 3), target(source.rows(), 3);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    source.row(static_cast<Eigen::Index>(i)) = mesh_neutral.row(pairs[i].first);
    target.row(static_cast<Eigen::Index>(i)) = surface_neutral.row(pairs[i].second);
  }
  return RbfMap(source, target);
}

/// A part of the source's surface that motion is looked for on.
struct SurfacePart {
  std::vector<int> triangles;  // of the whole surface
  std::unique_ptr<RayScene> scene;
  SurfacePoint whole(SurfacePoint place) const {
    place.triangle = triangles[place.triangle];
    return place;
  }
};

SurfacePart part_of_surface(const Topology& surface, const Points& neutral, const std::vector<bool>& vertices) {
  SurfacePart part;
  const Triangles& all = surface.triangles();
  for (int t = 0; t < all.rows(); ++t)
    if (vertices[all(t, 0)] && vertices[all(t, 1)] && vertices[all(t, 2)]) part.triangles.push_back(t);
  Triangles kept(static_cast<Eigen::Index>(part.triangles.size()), 3);
  for (std::size_t t = 0; t < part.triangles.size(); ++t)
    kept.row(static_cast<Eigen::Index>(t)) = all.row(part.triangles[t]);
  part.scene = std::make_unique<RayScene>(*Topology::from_triangles(surface.vertex_count(), kept), neutral);
  return part;
}

SurfacePoint along_normal(const SurfacePart& part, const Points& surface_normals, const Eigen::Vector3d& from,
                          const Eigen::Vector3d& normal, double reach) {
  SurfacePoint best;
  double best_distance = reach;
  for (double way : {1.0, -1.0}) {
    // Starting a hair behind the vertex also finds a surface that passes through it.
    const Eigen::Vector3d direction = way * normal;
    const auto hit = part.scene->hit(from - 1e-4 * direction, direction, 0.0, best_distance);
    if (!hit || normal.dot(surface_normals.row(part.triangles[hit->place.triangle])) < kSameWay) continue;
    best = part.whole(hit->place);
    best_distance = hit->distance;
  }
  return best;
}

std::vector<bool> members(const Topology& topology, const std::string& set) {
  std::vector<bool> inside(static_cast<std::size_t>(topology.vertex_count()), false);
  for (int v : topology.set(set)) inside[v] = true;
  return inside;
}

/// Skin looks for skin along its normals; eyeballs and rows of teeth, where both faces name them, take the nearest
/// place of their counterpart: a ray from an eyeball would meet the lids and bulge with every blink.
void find_places(const Topology& mesh, const Topology& surface, const Points& surface_neutral, double search_mm,
                 Correspondence& result) {
  const Points normals = vertex_normals(mesh, result.deformed);
  const Points surface_normals = triangle_normals(surface, surface_neutral);
  const SurfacePart skin = part_of_surface(surface, surface_neutral, skin_vertices(surface));
  std::vector<bool> solid(static_cast<std::size_t>(mesh.vertex_count()), false);
  for (const char* set : {"eyeball_left", "eyeball_right", "teeth_upper", "teeth_lower"}) {
    if (!mesh.has_set(set) || !surface.has_set(set)) continue;
    const SurfacePart part = part_of_surface(surface, surface_neutral, members(surface, set));
    for (int v : mesh.set(set)) {
      solid[v] = true;
      if (const auto closest = part.scene->closest(result.deformed.row(v).transpose()))
        result.places[v] = part.whole(closest->place);
    }
  }
  tbb::parallel_for(0, mesh.vertex_count(), [&](int v) {
    if (!solid[v] && normals.row(v).squaredNorm() > 0.0)
      result.places[v] = along_normal(skin, surface_normals, result.deformed.row(v).transpose(),
                                      normals.row(v).transpose(), search_mm);
  });
}

Points one_ring_average(const Adjacency& adjacency, const Points& values) {
  Points averaged = values;
  for (int v = 0; v < values.rows(); ++v) {
    for (int neighbour : adjacency.of(v)) averaged.row(v) += values.row(neighbour);
    averaged.row(v) /= 1.0 + static_cast<double>(adjacency.of(v).size());
  }
  return averaged;
}

/// Solves for the values of unknown vertices so that each is the mean of its neighbours.
void continue_harmonically(const Adjacency& adjacency, const std::vector<bool>& known, Points& values) {
  std::vector<int> sources;
  for (int v = 0; v < values.rows(); ++v)
    if (known[v]) sources.push_back(v);
  const EdgeDistances reach = edge_distances(adjacency, values, sources);
  std::vector<int> unknown, row(static_cast<std::size_t>(values.rows()), -1);
  for (int v = 0; v < values.rows(); ++v) {
    if (known[v] || reach.source[v] < 0) continue;
    row[v] = static_cast<int>(unknown.size());
    unknown.push_back(v);
  }
  if (unknown.empty()) return;
  const auto count = static_cast<Eigen::Index>(unknown.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count, 3);
  for (int r = 0; r < static_cast<int>(unknown.size()); ++r) {
    for (int neighbour : adjacency.of(unknown[r])) {
      entries.emplace_back(r, r, 1.0);
      if (row[neighbour] >= 0)
        entries.emplace_back(r, row[neighbour], -1.0);
      else
        right.row(r) += values.row(neighbour);
    }
  }
  Eigen::SparseMatrix<double> system(count, count);
  system.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(system);
  const Eigen::MatrixXd solved = solver.solve(right);
  for (int r = 0; r < static_cast<int>(unknown.size()); ++r) values.row(unknown[r]) = solved.row(r);
}

}  // namespace

Correspondence correspond(const Topology& mesh, const Points& mesh_neutral, const registration::Ibug68& mesh_points,
                          const Topology& surface, const Points& surface_neutral,
                          const registration::Ibug68& surface_points, double search_mm) {
  Correspondence result;
  result.deformed = surface_from_mesh(mesh_neutral, mesh_points, surface_neutral, surface_points)(mesh_neutral);
  result.places.resize(static_cast<std::size_t>(mesh.vertex_count()));
  find_places(mesh, surface, surface_neutral, search_mm, result);
  int found = 0;
  for (const SurfacePoint& place : result.places) found += place.valid() ? 1 : 0;
  result.found_share = static_cast<double>(found) / std::max(1, mesh.vertex_count());
  return result;
}

Points resample_motion(const Topology& mesh, const Correspondence& correspondence, const Topology& surface,
                       const Points& surface_motion, int smoothing_rounds) {
  Points motion = Points::Zero(mesh.vertex_count(), 3);
  std::vector<bool> known(correspondence.places.size());
  for (std::size_t v = 0; v < known.size(); ++v) {
    known[v] = correspondence.places[v].valid();
    if (known[v])
      motion.row(static_cast<Eigen::Index>(v)) =
          position_of(correspondence.places[v], surface, surface_motion).transpose();
  }
  const Adjacency neighbours = adjacency(mesh);
  continue_harmonically(neighbours, known, motion);
  for (int round = 0; round < smoothing_rounds; ++round) motion = one_ring_average(neighbours, motion);
  return motion;
}

}  // namespace vultus::rig
