#include "rig/motion_features.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace vultus::rig {
namespace {

constexpr double kKeptVariance = 0.99;

/// Displacements of the used vertices over the poses after the first: used × 3(poses − 1). `mirrored` turns x.
Eigen::MatrixXd displacements(std::span<const Points* const> poses, const std::vector<int>& vertices, bool mirrored) {
  const auto count = static_cast<Eigen::Index>(vertices.size()), others = static_cast<Eigen::Index>(poses.size()) - 1;
  Eigen::MatrixXd rows(count, 3 * others);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index p = 0; p < others; ++p) {
      rows.block<1, 3>(i, 3 * p) = poses[p + 1]->row(vertices[i]) - poses[0]->row(vertices[i]);
      if (mirrored) rows(i, 3 * p) *= -1.0;
    }
  return rows;
}

Eigen::MatrixXd principal_components(const Eigen::MatrixXd& rows) {
  const Eigen::MatrixXd centred = rows.rowwise() - rows.colwise().mean();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(centred.transpose() * centred);
  const Eigen::VectorXd values = solver.eigenvalues().cwiseMax(0.0);
  Eigen::Index kept = 0;
  for (double sum = 0.0; kept < values.size() && sum < kKeptVariance * values.sum(); ++kept)
    sum += values[values.size() - 1 - kept];
  return centred * solver.eigenvectors().rightCols(std::max<Eigen::Index>(kept, 1));
}

}  // namespace

std::vector<int> mirror_vertices(const Points& rest, const std::vector<bool>& candidates) {
  std::vector<int> vertices;
  for (int v = 0; v < rest.rows(); ++v)
    if (candidates[v]) vertices.push_back(v);
  Points places(static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t i = 0; i < vertices.size(); ++i) places.row(static_cast<Eigen::Index>(i)) = rest.row(vertices[i]);
  const PointTree tree(places);
  std::vector<int> mirror(static_cast<std::size_t>(rest.rows()));
  for (int v = 0; v < rest.rows(); ++v) {
    mirror[v] = v;
    if (!candidates[v]) continue;
    const Eigen::Vector3d image(-rest(v, 0), rest(v, 1), rest(v, 2));
    mirror[v] = vertices[tree.nearest(image, 1).front().index];
  }
  return mirror;
}

Eigen::VectorXd upper_face_side(const Points& neutral, const registration::Ibug68& points) {
  Eigen::VectorXd side = Eigen::VectorXd::Zero(neutral.rows());
  for (int needed : {33, 39, 42})
    if (points[needed] < 0) return side;
  const double eyes = 0.5 * (neutral(points[39], 1) + neutral(points[42], 1)), nose = neutral(points[33], 1);
  const double middle = 0.5 * (neutral(points[39], 0) + neutral(points[42], 0));
  const double apart = (neutral.row(points[42]) - neutral.row(points[39])).norm();
  for (Eigen::Index v = 0; v < side.size(); ++v) {
    // Full from a quarter of the nose below the eyes, nothing from its half on.
    const double height = std::clamp((neutral(v, 1) - 0.5 * (eyes + nose)) / (0.25 * (eyes - nose)), 0.0, 1.0);
    side[v] = height * std::tanh((neutral(v, 0) - middle) / (0.05 * apart));
  }
  return side;
}

Eigen::MatrixXd motion_features(std::span<const Points* const> poses, const std::vector<bool>& used,
                                const std::vector<int>& mirror, const Eigen::VectorXd& side,
                                const MotionFeatureWeights& weights) {
  std::vector<int> vertices, images;
  for (int v = 0; v < static_cast<int>(used.size()); ++v)
    if (used[v]) vertices.push_back(v);
  Eigen::MatrixXd motion = displacements(poses, vertices, false);
  if (!mirror.empty()) {
    for (int v : vertices) images.push_back(mirror[v]);
    const Eigen::MatrixXd other = displacements(poses, images, true);
    motion = (Eigen::MatrixXd(motion.rows(), 2 * motion.cols()) << motion, other).finished() / std::sqrt(2.0);
  }
  motion.rowwise().normalize();

  Eigen::MatrixXd place(motion.rows(), 3);
  for (Eigen::Index i = 0; i < place.rows(); ++i) place.row(i) = poses[0]->row(vertices[i]);
  place.rowwise() -= place.colwise().mean().eval();
  const double extent = std::sqrt(std::max(place.squaredNorm() / static_cast<double>(place.rows()), 1e-12));
  Eigen::VectorXd sides(motion.rows());
  for (Eigen::Index i = 0; i < sides.size(); ++i) sides[i] = side[vertices[i]];
  Eigen::MatrixXd joint(motion.rows(), motion.cols() + 4);
  joint << motion, weights.place / extent * place, weights.side * sides;
  const Eigen::MatrixXd reduced = principal_components(joint);
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(used.size()), reduced.cols());
  for (std::size_t i = 0; i < vertices.size(); ++i) rows.row(vertices[i]) = reduced.row(static_cast<Eigen::Index>(i));
  return rows;
}

}  // namespace vultus::rig
