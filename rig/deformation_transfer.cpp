#include "rig/deformation_transfer.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <set>

#include "core/error.h"
#include "core/neighbours.h"

namespace vultus::rig {
namespace {

constexpr double kContactWeight = 20.0;   // against cotangent weights near one
constexpr double kLeastCotangent = 1e-3;  // keeps every term ≥ 0 on obtuse triangles
constexpr double kMostCotangent = 20.0;
constexpr double kMostStretch = 30.0;  // a gradient beyond this comes from a sliver and says nothing
constexpr int kNearRings = 4;
constexpr int kNearestFew = 12;

Eigen::Matrix3d frame(const Points& positions, const Eigen::RowVector3i& corners) {
  const Eigen::Vector3d a = positions.row(corners[0]), u = positions.row(corners[1]).transpose() - a,
                        v = positions.row(corners[2]).transpose() - a;
  const Eigen::Vector3d normal = u.cross(v);
  Eigen::Matrix3d columns;
  columns << u, v, normal / std::sqrt(std::max(normal.norm(), 1e-300));
  return columns;
}

double clamped_cotangent(const Eigen::RowVector3d& u, const Eigen::RowVector3d& v) {
  const double sine = u.cross(v).norm();
  if (!(sine > 0.0)) return kLeastCotangent;
  return std::clamp(0.5 * u.dot(v) / sine, kLeastCotangent, kMostCotangent);
}

bool near_along_surface(const Adjacency& adjacency, int a, int b) {
  std::set<int> reached = {a};
  for (int ring = 0; ring < kNearRings; ++ring) {
    const std::set<int> old = reached;
    for (int v : old) reached.insert(adjacency.of(v).begin(), adjacency.of(v).end());
    if (reached.contains(b)) return true;
  }
  return false;
}

}  // namespace

DeformationTransfer::DeformationTransfer(const Topology& topology, const Points& source_neutral,
                                         const Points& target_neutral)
    : triangles_(topology.triangles()),
      source_(source_neutral),
      target_(target_neutral),
      cotangents_(topology.triangles().rows(), 3),
      areas_(Eigen::VectorXd::Zero(target_neutral.rows())) {
  for (Eigen::Index t = 0; t < triangles_.rows(); ++t) {
    const Eigen::RowVector3i c = triangles_.row(t);
    const Eigen::RowVector3d u = target_.row(c[1]) - target_.row(c[0]), v = target_.row(c[2]) - target_.row(c[0]);
    for (int k = 0; k < 3; ++k) {
      areas_[c[k]] += u.cross(v).norm() / 6.0;
      cotangents_(t, k) = clamped_cotangent(target_.row(c[(k + 1) % 3]) - target_.row(c[k]),
                                            target_.row(c[(k + 2) % 3]) - target_.row(c[k]));
    }
  }
}

Eigen::Matrix3d DeformationTransfer::gradient(Eigen::Index triangle, const Points& source_pose) const {
  const Eigen::RowVector3i corners = triangles_.row(triangle);
  const Eigen::Matrix3d rest = frame(source_, corners);
  if (!(std::abs(rest.determinant()) > 1e-12)) return Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d result = frame(source_pose, corners) * rest.inverse();
  return result.allFinite() && result.norm() < kMostStretch ? result : Eigen::Matrix3d::Identity();
}

Points DeformationTransfer::solve(const Points& source_pose, const Eigen::Matrix3d& rotation, const Points& anchors,
                                  const Eigen::VectorXd& strength,
                                  const std::vector<OffsetConstraint>& contacts) const {
  const Eigen::Index count = target_.rows();
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(triangles_.rows()) * 12 + contacts.size() * 4 + count);
  Points right = Points::Zero(count, 3);
  const auto couple = [&](int a, int b, double weight, const Eigen::RowVector3d& a_minus_b) {
    entries.emplace_back(a, a, weight);
    entries.emplace_back(b, b, weight);
    entries.emplace_back(a, b, -weight);
    entries.emplace_back(b, a, -weight);
    right.row(a) += weight * a_minus_b;
    right.row(b) -= weight * a_minus_b;
  };
  for (Eigen::Index t = 0; t < triangles_.rows(); ++t) {
    const Eigen::Matrix3d turned = rotation * gradient(t, source_pose) * rotation.transpose();
    for (int k = 0; k < 3; ++k) {
      const int a = triangles_(t, (k + 1) % 3), b = triangles_(t, (k + 2) % 3);
      couple(a, b, cotangents_(t, k), (target_.row(a) - target_.row(b)) * turned.transpose());
    }
  }
  for (const OffsetConstraint& contact : contacts) couple(contact.a, contact.b, kContactWeight, contact.offset);
  for (Eigen::Index v = 0; v < count; ++v) {
    // Vertices without faces have no area; they simply go where their anchor is.
    const double weight = strength[v] * std::max(areas_[v], 1e-6);
    entries.emplace_back(static_cast<int>(v), static_cast<int>(v), weight);
    right.row(v) += weight * anchors.row(v);
  }
  Eigen::SparseMatrix<double> system(count, count);
  system.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(system);
  if (solver.info() != Eigen::Success) throw InputError("motion transfer: the target mesh is degenerate");
  return solver.solve(Eigen::MatrixXd(right));
}

std::vector<std::pair<int, int>> contacts(const Topology& topology, const Points& positions, double distance) {
  if (!(distance > 0.0)) return {};
  const Adjacency neighbours = adjacency(topology);
  const Points normals = vertex_normals(topology, positions);
  const PointTree tree(positions);
  std::vector<int> partner(static_cast<std::size_t>(positions.rows()), -1);
  tbb::parallel_for(Eigen::Index{0}, positions.rows(), [&](Eigen::Index v) {
    for (const auto& near : tree.nearest(positions.row(v).transpose(), kNearestFew)) {
      if (near.distance > distance) break;
      if (normals.row(v).dot(normals.row(near.index)) > -0.2) continue;
      if (near_along_surface(neighbours, static_cast<int>(v), near.index)) continue;
      partner[static_cast<std::size_t>(v)] = near.index;
      break;
    }
  });
  std::vector<std::pair<int, int>> pairs;
  for (int v = 0; v < static_cast<int>(partner.size()); ++v)
    if (partner[v] >= 0) pairs.emplace_back(std::min(v, partner[v]), std::max(v, partner[v]));
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

}  // namespace vultus::rig
