#include "register/nonrigid.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/neighbours.h"
#include "register/fill.h"
#include "register/smooth_projection.h"
#include "register/unfold.h"

namespace vultus::registration {
namespace {

double anneal(double first, double last, double t) { return first * std::pow(last / first, t); }

// Pieces of the surface with at least one fitted vertex move with the graph.
std::vector<bool> active_vertices(const Topology& topology, const std::vector<bool>& fitted) {
  const std::vector<int> component = components(topology);
  std::vector<bool> touched(component.size(), false), active(component.size());
  for (std::size_t v = 0; v < fitted.size(); ++v)
    if (fitted[v]) touched[component[v]] = true;
  for (std::size_t v = 0; v < fitted.size(); ++v) active[v] = touched[component[v]];
  return active;
}

Eigen::VectorXd node_spacing(const Topology& topology, const Points& rest, const Points& detail,
                             const NonrigidOptions& options) {
  Eigen::VectorXd spacing = Eigen::VectorXd::Constant(rest.rows(), options.far_spacing);
  if (topology.has_set("face"))
    for (int v : topology.set("face")) spacing[v] = options.face_spacing;
  if (detail.rows() == 0) return spacing;
  const PointTree tree(detail);
  for (int v = 0; v < rest.rows(); ++v)
    if (tree.nearest(rest.row(v), 1).front().distance < 25.0) spacing[v] = options.fine_spacing;
  return spacing;
}

struct Matches {
  std::vector<PlaneTerm> planes;
  double mean_distance = 0.0;
};

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Tangent planes for every `stride`-th fitted vertex, weighted by Tukey's function of the distance to the plane and by
// how well the normals agree; weights sum to about one a node.
Matches find_matches(const Topology& topology, const Points& positions, const std::vector<int>& vertices,
                     const ScanSurface& scan, double limit, double least_cosine, int node_count) {
  const Points normals = vertex_normals(topology, positions);
  std::vector<std::optional<Correspondence>> found(vertices.size());
  tbb::parallel_for(std::size_t{0}, vertices.size(), [&](std::size_t i) {
    found[i] = scan.nearest(positions.row(vertices[i]), normals.row(vertices[i]), limit, least_cosine);
  });
  std::vector<double> residuals;
  for (const auto& place : found)
    if (place) residuals.push_back(place->distance);
  Matches matches;
  if (residuals.empty()) return matches;
  const double spread = std::max(0.5, 3.0 * 1.4826 * median(residuals));
  for (double residual : residuals) matches.mean_distance += residual / static_cast<double>(residuals.size());
  const double unit = static_cast<double>(node_count) / static_cast<double>(vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (!found[i]) continue;
    const double x = found[i]->distance / (2.0 * spread);
    if (x >= 1.0) continue;
    const double agree = found[i]->normal.dot(normals.row(vertices[i]));
    const double weight = unit * std::pow(1.0 - x * x, 2) * agree;
    matches.planes.push_back({vertices[i], found[i]->position, found[i]->normal, weight});
  }
  return matches;
}

}  // namespace

void NonrigidOptions::validate() const {
  if (!(fine_spacing > 0 && face_spacing > 0 && far_spacing > 0))
    throw InputError("non-rigid refinement: node spacings must be positive");
  if (!(first_stiffness > 0 && last_stiffness > 0 && first_limit > 0 && last_limit > 0))
    throw InputError("non-rigid refinement: stiffness and limits must be positive");
  if (!(first_landmarks > 0 && last_landmarks > 0))
    throw InputError("non-rigid refinement: landmark weights must be positive");
  if (stages < 1 || steps_a_stage < 1) throw InputError("non-rigid refinement needs at least one stage of one step");
}

NonrigidResult fit_nonrigid(const Topology& topology, const Points& rest, const Points& start,
                            const std::vector<bool>& fitted, const ScanSurface& scan,
                            const std::vector<PointTerm>& landmarks, const Points& detail,
                            const NonrigidOptions& options, Progress& progress) {
  options.validate();
  const std::vector<bool> active = active_vertices(topology, fitted);
  const DeformationGraph graph = make_graph(topology, rest, active, node_spacing(topology, rest, detail, options));
  GraphPose pose = pose_like(graph, rest, start, options.free_scale);
  GraphFit fit(graph, rest);
  std::vector<int> all;
  for (int v = 0; v < topology.vertex_count(); ++v)
    if (fitted[v]) all.push_back(v);

  NonrigidResult result{deformed(graph, pose, rest, start)};
  const double soft = 0.1 * options.first_stiffness;
  const GraphFitWeights opening{soft, soft, options.free_scale ? 0.0 : soft};
  std::vector<PointTerm> opening_pulls = landmarks;
  for (PointTerm& pull : opening_pulls) pull.weight *= 2.0 * options.first_landmarks;
  for (int step = 0; step < options.landmark_steps; ++step) fit.step(pose, {}, opening_pulls, opening);
  if (options.landmark_steps > 0) fit.relax(pose, options.landmark_relaxation);
  result.positions = deformed(graph, pose, rest, start);
  progress.begin("fitting", static_cast<std::size_t>(options.stages));
  for (int stage = 0; stage < options.stages; ++stage) {
    progress.check();
    const double t = options.stages > 1 ? static_cast<double>(stage) / (options.stages - 1) : 1.0;
    std::vector<int> vertices;  // while the graph is stiff, a part of the data says as much as all of it
    const int stride = 2 * stage < options.stages ? std::max<int>(1, static_cast<int>(all.size()) / 6000) : 1;
    for (std::size_t i = 0; i < all.size(); i += stride) vertices.push_back(all[i]);
    GraphFitWeights weights;
    weights.stiffness = anneal(options.first_stiffness, options.last_stiffness, t);
    weights.scale_stiffness = weights.stiffness;
    weights.keep_scale = options.free_scale ? 0.0 : 10.0 * weights.stiffness;
    std::vector<PointTerm> pulls = landmarks;
    for (PointTerm& pull : pulls) pull.weight *= anneal(options.first_landmarks, options.last_landmarks, t);
    const double limit = anneal(options.first_limit, options.last_limit, t);
    for (int step = 0; step < options.steps_a_stage; ++step) {
      const Matches matches =
          find_matches(topology, result.positions, vertices, scan, limit, options.least_cosine, graph.size());
      if (result.steps++ == 0) result.initial_error = matches.mean_distance;
      result.final_error = matches.mean_distance;
      const double moved = fit.step(pose, matches.planes, pulls, weights);
      result.positions = deformed(graph, pose, rest, start);
      if (moved < 0.01) break;
    }
    progress.advance();
  }
  result.positions = unfolded(topology, rest, result.positions);
  result.positions = project_smoothly(topology, result.positions, fitted, scan);
  result.positions = unfolded(topology, rest, result.positions);
  carry_components(topology, rest, fitted, options.free_scale, result.positions);
  return result;
}

}  // namespace vultus::registration
