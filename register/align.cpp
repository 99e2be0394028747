#include "register/align.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/statistics.h"

namespace vultus::registration {
namespace {

double tukey(double residual, double spread) {
  const double x = residual / (4.685 * spread);
  return std::abs(x) < 1.0 ? (1 - x * x) * (1 - x * x) : 0.0;
}

struct PlanePair {
  Eigen::Vector3d moved, target, normal;
};

// Places on the scan for the moved vertices, with normals turned along.
std::vector<PlanePair> find_pairs(const Points& positions, const Points& normals, const std::vector<int>& vertices,
                                  const ScanSurface& scan, const Similarity& motion, double limit,
                                  double least_cosine) {
  std::vector<PlanePair> pairs;
  for (int v : vertices) {
    const Eigen::Vector3d moved = motion * Eigen::Vector3d(positions.row(v));
    const Eigen::Vector3d normal = motion.rotation * normals.row(v).transpose();
    if (const auto found = scan.nearest(moved, normal, limit, least_cosine))
      pairs.push_back({moved, found->position, found->normal});
  }
  return pairs;
}

// One Gauss-Newton step about the pairs' centroid: small rotation, translation and, if free, log scale.
Similarity step(const std::vector<PlanePair>& pairs, const std::vector<double>& weights, Scaling scaling) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const PlanePair& pair : pairs) centre += pair.moved / static_cast<double>(pairs.size());
  using Vector7 = Eigen::Matrix<double, 7, 1>;
  Eigen::Matrix<double, 7, 7> normal_matrix = Eigen::Matrix<double, 7, 7>::Zero();
  Vector7 right = Vector7::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Vector3d arm = pairs[i].moved - centre;
    Vector7 row;
    row << arm.cross(pairs[i].normal), pairs[i].normal, (scaling == Scaling::free ? arm.dot(pairs[i].normal) : 0.0);
    const double residual = pairs[i].normal.dot(pairs[i].target - pairs[i].moved);
    normal_matrix += weights[i] * row * row.transpose();
    right += weights[i] * residual * row;
  }
  // A damping far below any data keeps a sphere's free rotation (and a fixed scale) at zero.
  normal_matrix.diagonal().array() += 1e-9 * normal_matrix.trace() + (scaling == Scaling::free ? 0.0 : 1e-9);
  const Vector7 x = normal_matrix.ldlt().solve(right);
  Similarity small;
  const Eigen::Vector3d turn = x.head<3>();
  small.rotation = turn.norm() > 1e-15 ? Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix()
                                       : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  small.scale = scaling == Scaling::free ? std::exp(std::clamp(x[6], -0.1, 0.1)) : 1.0;
  small.translation = centre + x.segment<3>(3) - small.scale * (small.rotation * centre);
  return small;
}

}  // namespace

Alignment align_landmarks(const Points& template_points, const Points& scan_points, const Eigen::VectorXd& confidence,
                          Scaling scaling) {
  std::vector<int> usable;
  for (int i = 0; i < confidence.size(); ++i)
    if (confidence[i] > 0.05) usable.push_back(i);
  if (usable.size() < 4)
    throw InputError("alignment needs at least 4 landmarks, " + std::to_string(usable.size()) + " are usable");
  const Points source = template_points(usable, Eigen::all), target = scan_points(usable, Eigen::all);
  Eigen::VectorXd weights = confidence(usable);
  Similarity motion = fit_similarity(source, target, scaling, weights);
  Eigen::VectorXd residuals;
  // Reweighting by hand, as `fit_similarity_robust` knows no confidence.
  for (int round = 0; round < 20; ++round) {
    residuals = (transformed(motion, source) - target).rowwise().norm();
    const double spread = std::max(0.5, 1.4826 * quantile(residuals, 0.5));
    for (int i = 0; i < weights.size(); ++i) weights[i] = confidence[usable[i]] * tukey(residuals[i], spread);
    motion = fit_similarity(source, target, scaling, weights);
  }
  Alignment result{motion, (transformed(motion, template_points) - scan_points).rowwise().norm(), 0.0};
  residuals = (transformed(motion, source) - target).rowwise().norm();
  result.rms = std::sqrt(weights.dot(residuals.cwiseAbs2()) / std::max(1e-12, weights.sum()));
  return result;
}

Alignment align_surface(const Topology& topology, const Points& positions, const std::vector<int>& vertices,
                        const ScanSurface& scan, const Similarity& start, Scaling scaling,
                        const RigidRefinement& options) {
  const Points normals = vertex_normals(topology, positions);
  Alignment result{start, {}, -1.0};
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    const double t = std::min(1.0, iteration / std::max(1.0, 0.6 * options.iterations));
    const double limit = options.first_limit * std::pow(options.last_limit / options.first_limit, t);
    const auto pairs =
        find_pairs(positions, normals, vertices, scan, result.scan_from_template, limit, options.least_cosine);
    if (pairs.size() < 12) break;
    std::vector<double> residuals;
    for (const PlanePair& pair : pairs) residuals.push_back(std::abs(pair.normal.dot(pair.target - pair.moved)));
    const double spread = std::max(0.05, 1.4826 * median(residuals));
    std::vector<double> weights;
    double total = 0.0, squares = 0.0;
    for (double residual : residuals) {
      weights.push_back(tukey(residual, spread));
      total += weights.back();
      squares += weights.back() * residual * residual;
    }
    const Similarity move = step(pairs, weights, scaling);
    result.scan_from_template = move * result.scan_from_template;
    result.residuals = Eigen::Map<const Eigen::VectorXd>(residuals.data(), static_cast<Eigen::Index>(residuals.size()));
    result.rms = std::sqrt(squares / std::max(1e-12, total));
    const double moved = (move * pairs.front().moved - pairs.front().moved).norm() +
                         (move * pairs.back().moved - pairs.back().moved).norm();
    if (t >= 1.0 && moved < 1e-3) break;
  }
  return result;
}

}  // namespace vultus::registration
