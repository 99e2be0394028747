#include "register/nonrigid.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/neighbours.h"
#include "core/statistics.h"
#include "register/fill.h"
#include "register/smooth_projection.h"
#include "register/unfold.h"

namespace vultus::registration {
namespace {

double between(double first, double last, double t) { return first * std::pow(last / first, t); }

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

// Tangent planes for every `stride`-th fitted vertex, weighted by Tukey's function of the distance to the plane and by
// how well the normals agree; weights sum to about one a node.
Matches find_matches(const Topology& topology, const Points& positions, const std::vector<int>& vertices,
                     const ScanSurface& scan, double limit, const NonrigidOptions& options, int node_count) {
  const Points normals = vertex_normals(topology, positions);
  std::vector<std::optional<Correspondence>> found(vertices.size());
  tbb::parallel_for(std::size_t{0}, vertices.size(), [&](std::size_t i) {
    found[i] = scan.nearest(positions.row(vertices[i]), normals.row(vertices[i]), limit, options.least_cosine);
  });
  std::vector<double> residuals;
  for (const auto& place : found)
    if (place) residuals.push_back(place->distance);
  Matches matches;
  if (residuals.empty()) return matches;
  const double spread = std::max(options.least_spread, 3.0 * 1.4826 * median(residuals));
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

// Both of each pair go to where they meet; a graph has no edge over the gap that could hold them together.
void add_meetings(const std::vector<std::pair<int, int>>& touching, const Points& positions,
                  std::vector<PointTerm>& points) {
  for (const auto& [a, b] : touching) {
    const Eigen::Vector3d middle = 0.5 * (positions.row(a) + positions.row(b)).transpose();
    for (int v : {a, b}) points.push_back({v, middle, 1.0});
  }
}

}  // namespace

void Annealing::validate() const {
  if (!(first_stiffness > 0 && last_stiffness > 0 && first_limit > 0 && last_limit > 0))
    throw InputError("non-rigid refinement: stiffness and limits must be positive");
  if (!(first_points > 0 && last_points > 0))
    throw InputError("non-rigid refinement: weights of points must be positive");
  if (stages < 1 || steps_a_stage < 1) throw InputError("non-rigid refinement needs at least one stage of one step");
}

void NonrigidOptions::validate() const {
  if (!(fine_spacing > 0 && face_spacing > 0 && far_spacing > 0))
    throw InputError("non-rigid refinement: node spacings must be positive");
  if (!(least_spread > 0)) throw InputError("non-rigid refinement: the spread of residuals must be positive");
  if (!(rigidity >= 0)) throw InputError("non-rigid refinement: rigidity must not be negative");
  annealing.validate();
}

NonrigidFit::NonrigidFit(const Topology& topology, const Points& rest, const Points& start,
                         const std::vector<bool>& fitted, const ScanSurface& scan, const Points& detail,
                         const NonrigidOptions& options)
    : topology_(topology),
      rest_(rest),
      start_(start),
      fitted_(fitted),
      scan_(scan),
      options_((options.validate(), options)),
      graph_(
          make_graph(topology, rest, active_vertices(topology, fitted), node_spacing(topology, rest, detail, options))),
      pose_(pose_like(graph_, rest, start, options.free_scale)),
      fit_(graph_, rest),
      result_{deformed(graph_, pose_, rest, start)} {
  for (int v = 0; v < topology.vertex_count(); ++v)
    if (fitted[v]) vertices_.push_back(v);
}

double NonrigidFit::unit() const {
  return static_cast<double>(graph_.size()) / static_cast<double>(std::max<std::size_t>(1, vertices_.size()));
}

void NonrigidFit::follow(const std::vector<PointTerm>& points, double stiffness, int steps) {
  GraphFitWeights weights;
  weights.smoothness = stiffness;
  weights.rigidity = options_.rigidity;
  for (int step = 0; step < steps; ++step) fit_.step(pose_, {}, points, weights);
  result_.positions = deformed(graph_, pose_, rest_, start_);
}

void NonrigidFit::anneal(const Pulls& pulls, const Annealing& annealing, Progress& progress) {
  annealing.validate();
  progress.begin("fitting", static_cast<std::size_t>(annealing.stages));
  for (int stage = 0; stage < annealing.stages; ++stage) {
    progress.check();
    const double t = annealing.stages > 1 ? static_cast<double>(stage) / (annealing.stages - 1) : 1.0;
    std::vector<int> vertices;  // while the graph is stiff, a part of the data says as much as all of it
    const int stride = 2 * stage < annealing.stages ? std::max<int>(1, static_cast<int>(vertices_.size()) / 6000) : 1;
    for (std::size_t i = 0; i < vertices_.size(); i += stride) vertices.push_back(vertices_[i]);
    GraphFitWeights weights;
    weights.smoothness = between(annealing.first_stiffness, annealing.last_stiffness, t);
    weights.rigidity = options_.rigidity;
    std::vector<PointTerm> drawn = pulls.annealed;
    for (PointTerm& point : drawn) point.weight *= between(annealing.first_points, annealing.last_points, t);
    drawn.insert(drawn.end(), pulls.kept.begin(), pulls.kept.end());
    const std::size_t lasting = drawn.size();
    const double limit = between(annealing.first_limit, annealing.last_limit, t);
    for (int step = 0; step < annealing.steps_a_stage; ++step) {
      const Matches matches =
          find_matches(topology_, result_.positions, vertices, scan_, limit, options_, graph_.size());
      if (result_.steps++ == 0) result_.initial_error = matches.mean_distance;
      result_.final_error = matches.mean_distance;
      drawn.resize(lasting);
      add_meetings(pulls.touching, result_.positions, drawn);
      const double moved = fit_.step(pose_, matches.planes, drawn, weights);
      result_.positions = deformed(graph_, pose_, rest_, start_);
      if (moved < 0.01) break;
    }
    progress.advance();
  }
}

NonrigidResult NonrigidFit::finished() const {
  NonrigidResult result = result_;
  result.positions = unfolded(topology_, rest_, result.positions);
  result.positions = project_smoothly(topology_, result.positions, fitted_, scan_);
  result.positions = unfolded(topology_, rest_, result.positions);
  carry_components(topology_, rest_, fitted_, options_.free_scale, result.positions);
  return result;
}

NonrigidResult fit_nonrigid(const Topology& topology, const Points& rest, const Points& start,
                            const std::vector<bool>& fitted, const ScanSurface& scan,
                            const std::vector<PointTerm>& points, const Points& detail, const NonrigidOptions& options,
                            Progress& progress) {
  NonrigidFit fit(topology, rest, start, fitted, scan, detail, options);
  fit.anneal({points, {}}, options.annealing, progress);
  return fit.finished();
}

}  // namespace vultus::registration
