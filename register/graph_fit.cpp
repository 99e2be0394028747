#include "register/graph_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace vultus::registration {

GraphFit::GraphFit(const DeformationGraph& graph, const Points& rest) : graph_(graph), rest_(rest) {
  std::vector<std::vector<int>> neighbours(graph.size());
  for (int node = 0; node < graph.size(); ++node) neighbours[node].push_back(node);
  reach_.assign(graph.size(), 0.0);
  for (const auto& [a, b] : graph.edges) {
    neighbours[a].push_back(b);
    neighbours[b].push_back(a);
    const double length2 = (graph.nodes.row(a) - graph.nodes.row(b)).squaredNorm();
    reach_[a] += length2;
    reach_[b] += length2;
  }
  offsets_.push_back(0);
  for (auto& row : neighbours) {
    std::sort(row.begin(), row.end());
    columns_.insert(columns_.end(), row.begin(), row.end());
    offsets_.push_back(static_cast<int>(columns_.size()));
  }
  blocks_.resize(columns_.size());
  right_.resize(graph.size());
}

GraphFit::Block& GraphFit::block(int row, int column) {
  const auto begin = columns_.begin() + offsets_[row], end = columns_.begin() + offsets_[row + 1];
  return blocks_[std::lower_bound(begin, end, column) - columns_.begin()];
}

Eigen::Vector3d GraphFit::hang(int vertex, const GraphPose& pose, std::vector<Hold>& holds) const {
  holds.clear();
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  for (int i = graph_.offsets[vertex]; i < graph_.offsets[vertex + 1]; ++i) {
    const auto& [node, weight] = graph_.influences[i];
    const Eigen::Vector3d arm = (rest_.row(vertex) - graph_.nodes.row(node)).transpose();
    position += weight * (pose.linear[node] * arm + (graph_.nodes.row(node) + pose.translation.row(node)).transpose());
    holds.push_back({node, weight * Shape(arm.x(), arm.y(), arm.z(), 1.0)});
  }
  return position;
}

void GraphFit::add(const std::vector<Hold>& holds, const Eigen::Matrix3d& metric, const Eigen::Vector3d& residual) {
  const Eigen::Vector3d pull = metric * residual;
  for (const Hold& a : holds) {
    for (int i = 0; i < 4; ++i) right_[a.node].segment<3>(3 * i) += a.shape[i] * pull;
    for (const Hold& b : holds) {
      Block& to = block(a.node, b.node);
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) to.block<3, 3>(3 * i, 3 * j) += (a.shape[i] * b.shape[j]) * metric;
    }
  }
}

void GraphFit::add_smoothness(const GraphPose& pose, const GraphFitWeights& weights) {
  const Eigen::Matrix3d unit = Eigen::Matrix3d::Identity();
  auto place = [&](int node) -> Eigen::Vector3d {
    return (graph_.nodes.row(node) + pose.translation.row(node)).transpose();
  };
  for (const auto& edge : graph_.edges) {
    for (const auto& [i, j] : {edge, std::pair(edge.second, edge.first)}) {
      const Eigen::Vector3d arm = (graph_.nodes.row(j) - graph_.nodes.row(i)).transpose();
      const Eigen::Vector3d predicted = pose.linear[i] * arm + place(i);
      add({{i, Shape(arm.x(), arm.y(), arm.z(), 1.0)}, {j, Shape(0, 0, 0, -1.0)}}, weights.smoothness * unit,
          place(j) - predicted);
    }
    const auto [i, j] = edge;
    const double weight =
        weights.smoothness * weights.gradient * (graph_.nodes.row(i) - graph_.nodes.row(j)).squaredNorm();
    const Eigen::Matrix3d difference = pose.linear[j] - pose.linear[i];
    for (int c = 0; c < 3; ++c) add({{i, Shape::Unit(c)}, {j, -Shape::Unit(c)}}, weight * unit, difference.col(c));
  }
}

void GraphFit::add_rigidity(const GraphPose& pose, double weight) {
  const Eigen::Matrix3d unit = Eigen::Matrix3d::Identity();
  for (int node = 0; node < graph_.size(); ++node) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(pose.linear[node], Eigen::ComputeFullU | Eigen::ComputeFullV);
    const bool mirrored = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0;
    const Eigen::Matrix3d rotation =
        svd.matrixU() * Eigen::Vector3d(1, 1, mirrored ? -1 : 1).asDiagonal() * svd.matrixV().transpose();
    const Eigen::Matrix3d difference = rotation - pose.linear[node];
    for (int c = 0; c < 3; ++c) add({{node, Shape::Unit(c)}}, weight * reach_[node] * unit, difference.col(c));
  }
}

std::vector<GraphFit::Part> GraphFit::solve() const {
  const int n = graph_.size();
  std::vector<Block> inverse(n);
  for (int node = 0; node < n; ++node)
    for (int k = offsets_[node]; k < offsets_[node + 1]; ++k)
      if (columns_[k] == node) inverse[node] = blocks_[k].ldlt().solve(Block::Identity());
  auto dot = [n](const std::vector<Part>& a, const std::vector<Part>& b) {
    double sum = 0.0;
    for (int i = 0; i < n; ++i) sum += a[i].dot(b[i]);
    return sum;
  };
  std::vector<Part> x(n, Part::Zero()), residual(right_.begin(), right_.end()), scaled(n), direction(n), image(n);
  for (int i = 0; i < n; ++i) scaled[i] = inverse[i] * residual[i];
  direction = scaled;
  double old = dot(residual, scaled);
  const double goal = 1e-5 * old;  // squared: three digits are enough for one step of many
  for (int iteration = 0; iteration < 200 && old > goal && old > 0.0; ++iteration) {
    for (int row = 0; row < n; ++row) {
      Part sum = Part::Zero();
      for (int k = offsets_[row]; k < offsets_[row + 1]; ++k) sum.noalias() += blocks_[k] * direction[columns_[k]];
      image[row] = sum;
    }
    const double length = old / dot(direction, image);
    for (int i = 0; i < n; ++i) {
      x[i] += length * direction[i];
      residual[i] -= length * image[i];
      scaled[i].noalias() = inverse[i] * residual[i];
    }
    const double next = dot(residual, scaled);
    for (int i = 0; i < n; ++i) direction[i] = scaled[i] + (next / old) * direction[i];
    old = next;
  }
  return x;
}

double GraphFit::step(GraphPose& pose, const std::vector<PlaneTerm>& planes, const std::vector<PointTerm>& points,
                      const GraphFitWeights& weights) {
  std::fill(blocks_.begin(), blocks_.end(), Block::Zero());
  std::fill(right_.begin(), right_.end(), Part::Zero());
  std::vector<Hold> holds;
  for (const PlaneTerm& term : planes) {
    const Eigen::Vector3d position = hang(term.vertex, pose, holds);
    add(holds, term.weight * term.normal * term.normal.transpose(), term.target - position);
  }
  for (const PointTerm& term : points) {
    const Eigen::Vector3d position = hang(term.vertex, pose, holds);
    add(holds, term.weight * Eigen::Matrix3d::Identity(), term.target - position);
  }
  add_smoothness(pose, weights);
  if (weights.rigidity > 0.0) add_rigidity(pose, weights.smoothness * weights.rigidity);
  for (int node = 0; node < graph_.size(); ++node) block(node, node).diagonal().array() += 1e-6;

  const std::vector<Part> x = solve();
  double moved = 0.0;
  for (int node = 0; node < graph_.size(); ++node) {
    for (int c = 0; c < 3; ++c) pose.linear[node].col(c) += x[node].segment<3>(3 * c);
    pose.translation.row(node) += x[node].tail<3>().transpose();
    moved += x[node].tail<3>().squaredNorm();
  }
  return std::sqrt(moved / std::max(1, graph_.size()));
}

}  // namespace vultus::registration
