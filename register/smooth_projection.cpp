#include "register/smooth_projection.h"

#include <tbb/parallel_for.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/neighbours.h"
#include "register/fill.h"
#include "register/unfold.h"

namespace vultus::registration {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

// A place of the mesh that is compared with the scan: the middle of two vertices, or one vertex twice.
struct Probe {
  int a, b;
  double slope_a = 0.0, slope_b = 0.0;  // change of the distance with the offset at a and b
  double distance = 0.0;                // to the tangent plane, along the scan's normal
  double weight = 0.0;
};

std::vector<Probe> make_probes(const Topology& topology, const std::vector<std::pair<int, int>>& all_edges,
                               const std::vector<bool>& fitted) {
  std::vector<Probe> probes;
  for (int v = 0; v < topology.vertex_count(); ++v)
    if (fitted[v]) probes.push_back({v, v});
  for (const auto& [a, b] : all_edges)
    if (fitted[a] && fitted[b]) probes.push_back({a, b});
  return probes;
}

void measure(std::vector<Probe>& probes, const Points& positions, const Points& normals, const ScanSurface& scan,
             const SmoothProjectionOptions& options) {
  tbb::parallel_for(std::size_t{0}, probes.size(), [&](std::size_t i) {
    Probe& probe = probes[i];
    const Eigen::Vector3d point = 0.5 * (positions.row(probe.a) + positions.row(probe.b)).transpose();
    const Eigen::Vector3d normal = (normals.row(probe.a) + normals.row(probe.b)).transpose().normalized();
    probe.weight = 0.0;
    const auto place = scan.nearest(point, normal, options.limit, options.least_cosine);
    if (!place) return;
    // Towards the nearest place itself; the scan's normal serves where that direction is all noise.
    Eigen::Vector3d towards = place->position - point;
    towards = place->distance > 0.3 ? Eigen::Vector3d(towards.normalized()) : place->normal;
    probe.distance = towards.dot(place->position - point);
    const double share = probe.a == probe.b ? 1.0 : 0.5;
    probe.slope_a = share * towards.dot(normals.row(probe.a));
    probe.slope_b = probe.a == probe.b ? 0.0 : share * towards.dot(normals.row(probe.b));
    const double far = place->distance / options.limit;
    probe.weight = std::pow(1.0 - far * far, 2) * (probe.a == probe.b ? 0.5 : 0.25);
  });
}

Sparse smoothness(const Topology& topology, const std::vector<std::pair<int, int>>& all_edges,
                  const SmoothProjectionOptions& options) {
  const int n = topology.vertex_count();
  std::vector<double> valence(n, 0.0);
  for (const auto& [a, b] : all_edges) {
    ++valence[a];
    ++valence[b];
  }
  Triplets umbrella, membrane;
  for (int v = 0; v < n; ++v)
    if (valence[v] > 0) umbrella.emplace_back(v, v, 1.0);
  for (const auto& [a, b] : all_edges) {
    umbrella.emplace_back(a, b, -1.0 / valence[a]);
    umbrella.emplace_back(b, a, -1.0 / valence[b]);
    membrane.emplace_back(a, a, options.membrane);
    membrane.emplace_back(b, b, options.membrane);
    membrane.emplace_back(a, b, -options.membrane);
    membrane.emplace_back(b, a, -options.membrane);
  }
  for (int v = 0; v < n; ++v) membrane.emplace_back(v, v, 1e-6);  // pieces without data stay where they are
  Sparse laplacian(n, n), first_order(n, n);
  laplacian.setFromTriplets(umbrella.begin(), umbrella.end());
  first_order.setFromTriplets(membrane.begin(), membrane.end());
  return Sparse(options.bending * (laplacian.transpose() * laplacian) + first_order);
}

// Movements without what would fold: around each fold vertices move as their surroundings do, a wider ring each time.
Points without_folds(const Topology& topology, const Adjacency& neighbours, const Points& positions, Points movements) {
  constexpr int widest = 5;  // rings: as far as a crease is from its surroundings
  for (int rings = 1; rings <= widest; ++rings) {
    const std::vector<bool> folded = folded_triangles(topology, positions, positions + movements);
    if (std::find(folded.begin(), folded.end(), true) == folded.end()) break;
    std::vector<bool> known(positions.rows(), true);
    for (std::size_t t = 0; t < folded.size(); ++t)
      for (int k = 0; folded[t] && k < 3; ++k) known[topology.triangles()(static_cast<int>(t), k)] = false;
    for (int ring = 0; ring < rings; ++ring) {
      const std::vector<bool> before = known;
      for (int v = 0; v < positions.rows(); ++v)
        if (!before[v])
          for (int next : neighbours.of(v)) known[next] = false;
    }
    movements = fill_smoothly(topology, positions, movements, known);
  }
  return movements;
}

}  // namespace

Points project_smoothly(const Topology& topology, const Points& positions, const std::vector<bool>& fitted,
                        const ScanSurface& scan, const SmoothProjectionOptions& options) {
  const auto all_edges = edges(topology);
  const Adjacency neighbours = adjacency(topology);
  const Sparse smooth = smoothness(topology, all_edges, options);
  std::vector<Probe> probes = make_probes(topology, all_edges, fitted);
  Eigen::SimplicialLDLT<Sparse> solver;
  Points result = positions;
  for (int round = 0; round < options.rounds; ++round) {
    const Points normals = vertex_normals(topology, result);
    measure(probes, result, normals, scan, options);
    Triplets entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(topology.vertex_count());
    std::vector<bool> compared(topology.vertex_count(), false);
    for (const Probe& probe : probes) {
      if (probe.weight <= 0.0) continue;
      compared[probe.a] = compared[probe.b] = true;
      entries.emplace_back(probe.a, probe.a, probe.weight * probe.slope_a * probe.slope_a);
      right[probe.a] += probe.weight * probe.slope_a * probe.distance;
      if (probe.a == probe.b) continue;
      entries.emplace_back(probe.b, probe.b, probe.weight * probe.slope_b * probe.slope_b);
      entries.emplace_back(probe.a, probe.b, probe.weight * probe.slope_a * probe.slope_b);
      entries.emplace_back(probe.b, probe.a, probe.weight * probe.slope_a * probe.slope_b);
      right[probe.b] += probe.weight * probe.slope_b * probe.distance;
    }
    for (int v = 0; v < topology.vertex_count(); ++v)
      if (!compared[v]) entries.emplace_back(v, v, options.stay);
    Sparse data(smooth.rows(), smooth.cols());
    data.setFromTriplets(entries.begin(), entries.end());
    const Sparse system = smooth + data;
    if (round == 0) solver.analyzePattern(smooth);  // data lies on edges, which bending has already
    solver.factorize(system);
    if (solver.info() != Eigen::Success) break;
    Eigen::VectorXd offset = solver.solve(right);
    offset = offset.cwiseMax(-options.limit).cwiseMin(options.limit);
    result += without_folds(topology, neighbours, result, offset.asDiagonal() * normals);
  }
  return result;
}

}  // namespace vultus::registration
