#include "register/deformation_graph.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <queue>

#include "core/neighbours.h"
#include "core/transform.h"

namespace vultus::registration {
namespace {

constexpr int nodes_per_vertex = 4;
constexpr double reach = 2.6;  // spacings over which a node is felt

struct Reached {
  double distance;
  int vertex;
  bool operator>(const Reached& other) const {
    return distance != other.distance ? distance > other.distance : vertex > other.vertex;
  }
};

// Shortest ways along edges over active vertices, again and again from different vertices.
class EdgeDistances {
 public:
  EdgeDistances(const Topology& topology, const Points& rest, const std::vector<bool>& active)
      : neighbours_(adjacency(topology)), rest_(rest), active_(active), best_(active.size(), infinite) {}

  // Calls `visit(vertex, distance)` for every active vertex within `limit`, nearest first.
  template <typename Visit>
  void from(int start, double limit, Visit visit) {
    std::priority_queue<Reached, std::vector<Reached>, std::greater<>> queue;
    touched_.clear();
    auto offer = [&](int vertex, double distance) {
      if (distance > limit || distance >= best_[vertex]) return;
      if (best_[vertex] == infinite) touched_.push_back(vertex);
      best_[vertex] = distance;
      queue.push({distance, vertex});
    };
    offer(start, 0.0);
    while (!queue.empty()) {
      const Reached at = queue.top();
      queue.pop();
      if (at.distance > best_[at.vertex]) continue;
      visit(at.vertex, at.distance);
      for (int next : neighbours_.of(at.vertex))
        if (active_[next]) offer(next, at.distance + (rest_.row(next) - rest_.row(at.vertex)).norm());
    }
    for (int vertex : touched_) best_[vertex] = infinite;
  }

 private:
  static constexpr double infinite = std::numeric_limits<double>::infinity();
  Adjacency neighbours_;
  const Points& rest_;
  const std::vector<bool>& active_;
  std::vector<double> best_;
  std::vector<int> touched_;
};

struct Felt {
  int node;
  double relative;  // distance over the node's reach, [0, 1]
};

// The nearest few nodes of a vertex, weighted to vanish where the next node takes over.
std::vector<DeformationGraph::Influence> weigh(std::vector<Felt> felt) {
  std::sort(felt.begin(), felt.end(), [](const Felt& a, const Felt& b) {
    return a.relative != b.relative ? a.relative < b.relative : a.node < b.node;
  });
  const double edge = felt.size() > nodes_per_vertex ? felt[nodes_per_vertex].relative : 1.0;
  if (felt.size() > nodes_per_vertex) felt.resize(nodes_per_vertex);
  std::vector<DeformationGraph::Influence> influences;
  double total = 0.0;
  for (const Felt& one : felt) {
    const double weight = std::max(1e-6, std::pow(1.0 - one.relative / std::max(1e-9, edge * 1.0001), 2));
    influences.push_back({one.node, weight});
    total += weight;
  }
  for (auto& influence : influences) influence.weight /= total;
  return influences;
}

}  // namespace

DeformationGraph make_graph(const Topology& topology, const Points& rest, const std::vector<bool>& active,
                            const Eigen::VectorXd& spacing) {
  DeformationGraph graph;
  const int n = topology.vertex_count();
  EdgeDistances ways(topology, rest, active);
  std::vector<double> covered(n, std::numeric_limits<double>::infinity());
  std::vector<std::vector<Felt>> felt(n);
  for (int v = 0; v < n; ++v) {
    if (!active[v] || covered[v] < spacing[v]) continue;
    const int node = graph.size();
    graph.node_vertex.push_back(v);
    const double range = reach * spacing[v];
    ways.from(v, range, [&](int vertex, double distance) {
      covered[vertex] = std::min(covered[vertex], distance);
      felt[vertex].push_back({node, distance / range});
    });
  }
  graph.nodes = rest(graph.node_vertex, Eigen::all);
  graph.offsets.push_back(0);
  for (int v = 0; v < n; ++v) {
    if (active[v] && !felt[v].empty()) {
      const auto influences = weigh(felt[v]);
      graph.influences.insert(graph.influences.end(), influences.begin(), influences.end());
      for (std::size_t a = 0; a < influences.size(); ++a)
        for (std::size_t b = a + 1; b < influences.size(); ++b)
          graph.edges.push_back(std::minmax(influences[a].node, influences[b].node));
    }
    graph.offsets.push_back(static_cast<int>(graph.influences.size()));
  }
  std::sort(graph.edges.begin(), graph.edges.end());
  graph.edges.erase(std::unique(graph.edges.begin(), graph.edges.end()), graph.edges.end());
  return graph;
}

GraphPose GraphPose::rest(const DeformationGraph& graph) {
  return {std::vector<Eigen::Matrix3d>(graph.size(), Eigen::Matrix3d::Identity()), Points::Zero(graph.size(), 3)};
}

Points deformed(const DeformationGraph& graph, const GraphPose& pose, const Points& rest, const Points& otherwise) {
  Points moved = otherwise;
  for (int v = 0; v < rest.rows(); ++v) {
    if (graph.offsets[v] == graph.offsets[v + 1]) continue;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int i = graph.offsets[v]; i < graph.offsets[v + 1]; ++i) {
      const auto& [node, weight] = graph.influences[i];
      const Eigen::Vector3d arm = (rest.row(v) - graph.nodes.row(node)).transpose();
      sum += weight * (pose.linear[node] * arm + (graph.nodes.row(node) + pose.translation.row(node)).transpose());
    }
    moved.row(v) = sum;
  }
  return moved;
}

GraphPose pose_like(const DeformationGraph& graph, const Points& rest, const Points& positions, bool free_scale) {
  std::vector<std::vector<int>> members(graph.size());
  for (int v = 0; v < rest.rows(); ++v)
    for (int i = graph.offsets[v]; i < graph.offsets[v + 1]; ++i) members[graph.influences[i].node].push_back(v);
  GraphPose pose = GraphPose::rest(graph);
  for (int node = 0; node < graph.size(); ++node) {
    const auto& vertices = members[node];
    const int own = graph.node_vertex[node];
    pose.translation.row(node) = positions.row(own) - rest.row(own);
    if (vertices.size() < 6) continue;
    const Points source = rest(vertices, Eigen::all).rowwise() - rest.row(own);
    const Points target = positions(vertices, Eigen::all).rowwise() - positions.row(own);
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(target.transpose() * source, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Vector3d signs(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
    pose.linear[node] = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
    if (free_scale) {
      const double spread = source.squaredNorm();
      if (spread > 0) pose.linear[node] *= svd.singularValues().dot(signs) / spread;
    }
  }
  return pose;
}

}  // namespace vultus::registration
