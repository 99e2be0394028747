#include "register/graph_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace vultus::registration {
namespace {

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

}  // namespace

GraphFit::GraphFit(const DeformationGraph& graph, const Points& rest) : graph_(graph), rest_(rest) {
  std::vector<std::vector<int>> neighbours(graph.size());
  for (int node = 0; node < graph.size(); ++node) neighbours[node].push_back(node);
  for (const auto& [a, b] : graph.edges) {
    neighbours[a].push_back(b);
    neighbours[b].push_back(a);
  }
  offsets_.push_back(0);
  for (auto& row : neighbours) {
    std::sort(row.begin(), row.end());
    columns_.insert(columns_.end(), row.begin(), row.end());
    offsets_.push_back(static_cast<int>(columns_.size()));
  }
  blocks_.resize(columns_.size());
  right_.resize(graph.size());
  arms_.resize(2 * graph.edges.size(), 3);
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    arms_.row(2 * e) = graph.nodes.row(graph.edges[e].second) - graph.nodes.row(graph.edges[e].first);
    arms_.row(2 * e + 1) = -arms_.row(2 * e);
  }
}

void GraphFit::relax(const GraphPose& pose, double share) {
  for (int row = 0; row < arms_.rows(); ++row) {
    auto [i, j] = graph_.edges[row / 2];
    if (row % 2 == 1) std::swap(i, j);
    const Eigen::Vector3d arm =
        (graph_.nodes.row(j) + pose.translation.row(j) - graph_.nodes.row(i) - pose.translation.row(i)).transpose();
    const Eigen::Vector3d seen = pose.linear[i].inverse() * arm;
    arms_.row(row) += share * (seen.transpose() - arms_.row(row));
  }
}

GraphFit::Block& GraphFit::block(int row, int column) {
  const auto begin = columns_.begin() + offsets_[row], end = columns_.begin() + offsets_[row + 1];
  return blocks_[std::lower_bound(begin, end, column) - columns_.begin()];
}

void GraphFit::vertex_columns(int vertex, const GraphPose& pose, std::vector<Column>& columns,
                              Eigen::Vector3d& position) const {
  columns.clear();
  position.setZero();
  for (int i = graph_.offsets[vertex]; i < graph_.offsets[vertex + 1]; ++i) {
    const auto& [node, weight] = graph_.influences[i];
    const Eigen::Vector3d arm = pose.linear[node] * (rest_.row(vertex) - graph_.nodes.row(node)).transpose();
    position += weight * (arm + (graph_.nodes.row(node) + pose.translation.row(node)).transpose());
    Column column;
    column.node = node;
    column.jacobian << -weight * cross_matrix(arm), weight * arm, weight * Eigen::Matrix3d::Identity();
    columns.push_back(column);
  }
}

// Adds residualᵀ·metric·residual, linearized; `residual` is what is wanted minus what is.
void GraphFit::add_rows(const std::vector<Column>& columns, const Eigen::Matrix3d& metric,
                        const Eigen::Vector3d& residual) {
  for (const Column& a : columns) {
    const Eigen::Matrix<double, unknowns, 3> weighted = a.jacobian.transpose() * metric;
    right_[a.node] += weighted * residual;
    for (const Column& b : columns) block(a.node, b.node) += weighted * b.jacobian;
  }
}

void GraphFit::add_stiffness(const GraphPose& pose, const GraphFitWeights& weights) {
  std::vector<Column> columns(2);
  for (std::size_t e = 0; e < graph_.edges.size(); ++e) {
    const auto& edge = graph_.edges[e];
    for (int side : {0, 1}) {
      const auto [i, j] = side == 0 ? edge : std::pair(edge.second, edge.first);
      const Eigen::Vector3d arm = pose.linear[i] * arms_.row(2 * e + side).transpose();
      const Eigen::Vector3d predicted = arm + (graph_.nodes.row(i) + pose.translation.row(i)).transpose();
      const Eigen::Vector3d residual = (graph_.nodes.row(j) + pose.translation.row(j)).transpose() - predicted;
      columns[0].node = i;
      columns[0].jacobian << -cross_matrix(arm), arm, Eigen::Matrix3d::Identity();
      columns[1].node = j;
      columns[1].jacobian.rightCols<3>() = -Eigen::Matrix3d::Identity();
      add_rows(columns, weights.stiffness * Eigen::Matrix3d::Identity(), residual);
    }
    const auto [i, j] = edge;
    const double length2 = (graph_.nodes.row(i) - graph_.nodes.row(j)).squaredNorm();
    auto log_scale = [&](int node) { return std::log(pose.linear[node].col(0).norm()); };
    const double si = log_scale(i), sj = log_scale(j);
    const double link = weights.scale_stiffness * length2, keep = weights.keep_scale * length2;
    block(i, i)(3, 3) += link + keep;
    block(j, j)(3, 3) += link + keep;
    block(i, j)(3, 3) -= link;
    block(j, i)(3, 3) -= link;
    right_[i][3] -= link * (si - sj) + keep * si;
    right_[j][3] -= link * (sj - si) + keep * sj;
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
  std::vector<Part> x(n, Part::Zero()), residual = right_, scaled(n), direction(n), image(n);
  for (int i = 0; i < n; ++i) scaled[i] = inverse[i] * residual[i];
  direction = scaled;
  double old = dot(residual, scaled);
  const double goal = 1e-5 * old;  // squared: three digits are enough for one step of many
  for (int iteration = 0; iteration < 250 && old > goal && old > 0.0; ++iteration) {
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
  std::vector<Column> columns;
  Eigen::Vector3d position;
  for (const PlaneTerm& term : planes) {
    vertex_columns(term.vertex, pose, columns, position);
    add_rows(columns, term.weight * term.normal * term.normal.transpose(), term.target - position);
  }
  for (const PointTerm& term : points) {
    vertex_columns(term.vertex, pose, columns, position);
    add_rows(columns, term.weight * Eigen::Matrix3d::Identity(), term.target - position);
  }
  add_stiffness(pose, weights);
  for (int node = 0; node < graph_.size(); ++node) block(node, node).diagonal().array() += 1e-6;

  const std::vector<Part> x = solve();
  double moved = 0.0;
  for (int node = 0; node < graph_.size(); ++node) {
    Eigen::Vector3d turn = x[node].head<3>();
    if (turn.norm() > 0.5) turn *= 0.5 / turn.norm();  // the linearization means nothing beyond that
    if (turn.norm() > 0.0)
      pose.linear[node] = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * pose.linear[node];
    pose.linear[node] *= std::exp(std::clamp(x[node][3], -0.2, 0.2));
    pose.translation.row(node) += x[node].tail<3>().transpose();
    moved += x[node].tail<3>().squaredNorm();
  }
  return std::sqrt(moved / std::max(1, graph_.size()));
}

}  // namespace vultus::registration
