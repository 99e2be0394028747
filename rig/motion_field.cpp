#include "rig/motion_field.h"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"

namespace vultus::rig {
namespace {

constexpr int kMostSweeps = 1000;

/// Disjoint sets that also know each member's sign against its root's.
class SignedSets {
 public:
  explicit SignedSets(int count) : parent_(count), sign_(count, 1) { std::iota(parent_.begin(), parent_.end(), 0); }

  /// Root of v and v's sign against it.
  std::pair<int, int> find(int v) {
    int root = v, sign = 1;
    for (; parent_[root] != root; root = parent_[root]) sign *= sign_[root];
    for (int from_root = sign; parent_[v] != root && v != root;) {
      const int next = parent_[v], own = sign_[v];
      parent_[v] = root;
      sign_[v] = from_root;
      from_root *= own;
      v = next;
    }
    return {root, sign};
  }

  /// Makes sign(a)·sign(b) = relative, unless they are joined already.
  void join(int a, int b, int relative) {
    const auto [root_a, sign_a] = find(a);
    const auto [root_b, sign_b] = find(b);
    if (root_a == root_b) return;
    parent_[root_b] = root_a;
    sign_[root_b] = relative * sign_a * sign_b;
  }

 private:
  std::vector<int> parent_, sign_;
};

double energy(const MotionField& field, const Adjacency& adjacency) {
  double sum = 0.0;
  for (int v = 0; v < field.directions.rows(); ++v)
    for (int neighbour : adjacency.of(v))
      if (neighbour > v) sum -= field.directions.row(v).dot(field.directions.row(neighbour));
  return sum;
}

struct Edge {
  double agreement;
  int a, b, sign;
};

std::vector<Edge> edges_by_agreement(const MotionField& field, const Adjacency& adjacency) {
  std::vector<Edge> edges;
  for (int v = 0; v < field.directions.rows(); ++v)
    for (int neighbour : adjacency.of(v)) {
      if (neighbour < v) continue;
      const double dot = field.directions.row(v).dot(field.directions.row(neighbour));
      edges.push_back({std::abs(dot), v, neighbour, dot < 0.0 ? -1 : 1});
    }
  std::stable_sort(edges.begin(), edges.end(), [](const Edge& x, const Edge& y) { return x.agreement > y.agreement; });
  return edges;
}

int flip_while_it_helps(MotionField& field, const Adjacency& adjacency) {
  int sweeps = 0;
  for (bool flipped = true; flipped && sweeps < kMostSweeps; ++sweeps) {
    flipped = false;
    for (int v = 0; v < field.directions.rows(); ++v) {
      Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
      for (int neighbour : adjacency.of(v)) sum += field.directions.row(neighbour);
      if (field.directions.row(v).dot(sum) >= 0.0) continue;
      field.directions.row(v) *= -1.0;
      flipped = true;
    }
  }
  return sweeps;
}

}  // namespace

MotionField motion_field(std::span<const Points* const> poses) {
  if (poses.size() < 2) throw InputError("segmentation needs at least two poses, so that something moves");
  const Eigen::Index count = poses[0]->rows();
  MotionField field{Points::Zero(count, 3), Eigen::VectorXd::Zero(count), Eigen::VectorXd::Zero(count),
                    Eigen::VectorXd::Zero(count)};
  tbb::parallel_for(Eigen::Index{0}, count, [&](Eigen::Index v) {
    Eigen::RowVector3d mean = Eigen::RowVector3d::Zero();
    for (const Points* pose : poses) {
      mean += pose->row(v);
      field.range[v] = std::max(field.range[v], (pose->row(v) - poses[0]->row(v)).norm());
    }
    mean /= static_cast<double>(poses.size());
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const Points* pose : poses) {
      const Eigen::Vector3d d = (pose->row(v) - mean).transpose();
      covariance += d * d.transpose();
    }
    covariance /= static_cast<double>(poses.size());
    if (!(covariance.trace() > 0.0)) return;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
    const Eigen::Vector3d values = solver.eigenvalues().cwiseMax(0.0);
    field.directions.row(v) = solver.eigenvectors().col(2).transpose();
    field.deviation[v] = std::sqrt(values[2]);
    field.certainty[v] = 1.0 - values[1] / values[2];
  });
  return field;
}

Coordination coordinate_signs(MotionField& field, const Adjacency& adjacency) {
  const int count = static_cast<int>(field.directions.rows());
  Coordination result;
  result.initial_energy = energy(field, adjacency);
  SignedSets sets(count);
  for (const Edge& edge : edges_by_agreement(field, adjacency)) sets.join(edge.a, edge.b, edge.sign);
  for (int v = 0; v < count; ++v) field.directions.row(v) *= sets.find(v).second;
  result.sweeps = flip_while_it_helps(field, adjacency);

  Points sum = Points::Zero(count, 3);
  for (int v = 0; v < count; ++v) sum.row(sets.find(v).first) += field.deviation[v] * field.directions.row(v);
  for (int v = 0; v < count; ++v) {
    const Eigen::RowVector3d whole = sum.row(sets.find(v).first);
    Eigen::Index main_axis = 1;
    if (std::abs(whole.y()) < 1e-6 * whole.norm()) whole.cwiseAbs().maxCoeff(&main_axis);
    if (whole[main_axis] < 0.0) field.directions.row(v) *= -1.0;
  }
  result.final_energy = energy(field, adjacency);
  return result;
}

void smooth_directions(MotionField& field, const Adjacency& adjacency, int rounds) {
  const Eigen::Index count = field.directions.rows();
  for (int round = 0; round < rounds; ++round) {
    const Points old = field.directions;
    tbb::parallel_for(Eigen::Index{0}, count, [&](Eigen::Index v) {
      Eigen::RowVector3d around = Eigen::RowVector3d::Zero();
      double weight = 0.0;
      for (int neighbour : adjacency.of(static_cast<int>(v))) {
        const double w = field.certainty[neighbour] * field.deviation[neighbour];
        around += w * old.row(neighbour);
        weight += w;
      }
      if (!(weight > 0.0)) return;
      const Eigen::RowVector3d blended = field.certainty[v] * old.row(v) + around / weight;
      if (blended.norm() > 1e-9) field.directions.row(v) = blended.normalized();
    });
  }
}

}  // namespace vultus::rig
