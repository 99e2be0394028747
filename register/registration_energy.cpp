#include "register/registration_energy.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "core/error.h"

namespace vultus::registration {
namespace {

/// An edge of the triangulated view with the third corners of its triangles, as the first of them runs a → b.
struct MeshEdge {
  int a, b, c, d;
};

std::vector<MeshEdge> skin_edges(const Topology& topology, const std::vector<bool>& skin) {
  std::map<std::pair<int, int>, MeshEdge> found;
  for (int t = 0; t < topology.triangles().rows(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = topology.triangles()(t, k), b = topology.triangles()(t, (k + 1) % 3),
                c = topology.triangles()(t, (k + 2) % 3);
      if (!skin[a] || !skin[b] || !skin[c]) continue;
      const auto [place, fresh] = found.try_emplace(std::minmax(a, b), MeshEdge{a, b, c, -1});
      if (!fresh && place->second.a == b) place->second.d = c;
    }
  std::vector<MeshEdge> edges;
  for (const auto& [ends, edge] : found) edges.push_back(edge);
  return edges;
}

// Every n-th, so that at most `most` are left.
template <typename T>
std::vector<T> evenly(const std::vector<T>& all, int most) {
  std::vector<T> some;
  const std::size_t count = std::min<std::size_t>(all.size(), most);
  for (std::size_t i = 0; i < count; ++i) some.push_back(all[i * all.size() / count]);
  return some;
}

Eigen::Vector3d row(const Points& points, int i) { return points.row(i).transpose(); }

// Derivative of n·k by the corners a, b, c of the triangle that n is the unit normal of.
Eigen::Matrix3d normal_slope(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                             const Eigen::Vector3d& k) {
  const Eigen::Vector3d doubled = (b - a).cross(c - a);
  const double area = std::max(1e-12, doubled.norm());
  const Eigen::Vector3d n = doubled / area, g = (k - n * n.dot(k)) / area;
  Eigen::Matrix3d slope;
  slope.col(1) = (c - a).cross(g);
  slope.col(2) = g.cross(b - a);
  slope.col(0) = -slope.col(1) - slope.col(2);
  return slope;
}

Eigen::Vector3d unit_normal(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d doubled = (b - a).cross(c - a);
  return doubled / std::max(1e-12, doubled.norm());
}

}  // namespace

double soft_absolute(double x, double softness) { return std::sqrt(x * x + softness * softness) - softness; }

double soft_absolute_slope(double x, double softness) {
  const double root = std::sqrt(x * x + softness * softness);
  return root > 0.0 ? x / root : 0.0;
}

void EnergyOptions::validate() const {
  if (!(weights.distance >= 0.0 && weights.strain >= 0.0 && weights.bending >= 0.0))
    throw InputError("registration energy: weights must not be negative");
  if (!(softness >= 0.0)) throw InputError("registration energy: the softness must not be negative");
  if (most_vertices < 1 || most_edges < 1)
    throw InputError("registration energy: at least one vertex and one edge must take part");
}

RegistrationEnergy::RegistrationEnergy(const Topology& topology, const Points& reference, const PlanarBones& bones,
                                       const std::vector<bool>& fitted, const ScanSurface& scan,
                                       const EnergyOptions& options)
    : topology_(topology), bones_(bones), scan_(scan), options_(options) {
  options_.validate();
  std::vector<int> slot(topology.vertex_count(), -1), skin;
  auto slot_of = [&](int v) {
    if (v >= 0 && slot[v] < 0) {
      slot[v] = static_cast<int>(vertices_.size());
      vertices_.push_back(v);
    }
    return v < 0 ? -1 : slot[v];
  };
  for (int v = 0; v < topology.vertex_count(); ++v)
    if (fitted[v] && !bones.bindings(v).empty()) skin.push_back(v);
  for (int v : evenly(skin, options_.most_vertices)) sampled_.push_back(slot_of(v));
  double total = 0.0;
  for (const MeshEdge& edge : evenly(skin_edges(topology, fitted), options_.most_edges)) {
    edges_.push_back({slot_of(edge.a), slot_of(edge.b), slot_of(edge.c), slot_of(edge.d), 0.0, 0.0});
    bent_ += edge.d >= 0;
  }
  const Points at_reference = reference(vertices_, Eigen::all);
  for (Edge& edge : edges_) {
    edge.length = strain_of(edge, at_reference).value;
    edge.bend = edge.d >= 0 ? bending_of(edge, at_reference).value : 0.0;
    total += edge.length;
  }
  if (!edges_.empty()) edge_length_ = std::max(1e-9, total / static_cast<double>(edges_.size()));
}

int RegistrationEnergy::find_data(const Points& control, double limit) {
  const Points positions = bones_(control);
  const Points normals = vertex_normals(topology_, positions);
  std::vector<char> seen(sampled_.size(), 0);
  tbb::parallel_for(std::size_t{0}, sampled_.size(), [&](std::size_t i) {
    const int v = vertices_[sampled_[i]];
    seen[i] = scan_.nearest(positions.row(v), normals.row(v), limit, options_.least_cosine).has_value();
  });
  with_data_.clear();
  for (std::size_t i = 0; i < sampled_.size(); ++i)
    if (seen[i]) with_data_.push_back(sampled_[i]);
  return static_cast<int>(with_data_.size());
}

RegistrationEnergy::Residual RegistrationEnergy::distance_of(const Eigen::Vector3d& position) const {
  Residual residual;
  const auto place = scan_.rays().closest(position);
  if (!place) return residual;
  residual.value = place->distance;
  // On the surface itself the distance has no derivative; along its normal it is what it is a little off it.
  residual.by_slot.col(0) = place->distance > 1e-9 ? Eigen::Vector3d((position - place->position) / place->distance)
                                                   : scan_.normal_at(place->place);
  return residual;
}

RegistrationEnergy::Residual RegistrationEnergy::strain_of(const Edge& edge, const Points& slots) {
  Residual residual;
  const Eigen::Vector3d arm = row(slots, edge.b) - row(slots, edge.a);
  const double length = arm.norm();
  residual.value = length - edge.length;
  residual.by_slot.col(1) = arm / std::max(1e-12, length);
  residual.by_slot.col(0) = -residual.by_slot.col(1);
  return residual;
}

RegistrationEnergy::Residual RegistrationEnergy::bending_of(const Edge& edge, const Points& slots) {
  Residual residual;
  if (edge.d < 0) return residual;
  const Eigen::Vector3d a = row(slots, edge.a), b = row(slots, edge.b), c = row(slots, edge.c), d = row(slots, edge.d);
  const Eigen::Vector3d left = unit_normal(a, b, c), right = unit_normal(b, a, d);
  residual.value = left.dot(right) - edge.bend;
  const Eigen::Matrix3d of_left = normal_slope(a, b, c, right), of_right = normal_slope(b, a, d, left);
  residual.by_slot.col(0) = of_left.col(0) + of_right.col(1);
  residual.by_slot.col(1) = of_left.col(1) + of_right.col(0);
  residual.by_slot.col(2) = of_left.col(2);
  residual.by_slot.col(3) = of_right.col(2);
  return residual;
}

double RegistrationEnergy::distance_share() const {
  return with_data_.empty() ? 0.0 : options_.weights.distance / static_cast<double>(with_data_.size());
}

double RegistrationEnergy::strain_share() const {
  return edges_.empty() ? 0.0 : options_.weights.strain / (edge_length_ * static_cast<double>(edges_.size()));
}

double RegistrationEnergy::bending_share() const {
  return bent_ == 0 ? 0.0 : options_.weights.bending / static_cast<double>(bent_);
}

EnergyTerms RegistrationEnergy::operator()(const Points& control) const {
  const Points slots = bones_(control, vertices_);
  EnergyTerms terms;
  for (int s : with_data_) terms.distance += soft_absolute(distance_of(row(slots, s)).value, softness());
  for (const Edge& edge : edges_) {
    terms.strain += soft_absolute(strain_of(edge, slots).value, softness());
    terms.bending += soft_absolute(bending_of(edge, slots).value, bending_softness());
  }
  terms.total = distance_share() * terms.distance + strain_share() * terms.strain + bending_share() * terms.bending;
  terms.distance /= std::max<std::size_t>(1, with_data_.size());
  terms.strain /= std::max<std::size_t>(1, edges_.size());
  terms.bending /= std::max(1, bent_);
  return terms;
}

Points RegistrationEnergy::gradient(const Points& control) const {
  const PlanarBones::Derivatives moved = bones_.derivatives(control, vertices_);
  Points by_slot = Points::Zero(vertices_.size(), 3);
  for (int s : with_data_) {
    const Residual r = distance_of(row(moved.positions, s));
    by_slot.row(s) += distance_share() * soft_absolute_slope(r.value, softness()) * r.by_slot.col(0).transpose();
  }
  auto add = [&](const Edge& edge, const Residual& r, double factor) {
    const int corners[4] = {edge.a, edge.b, edge.c, edge.d};
    for (int k = 0; k < 4; ++k)
      if (corners[k] >= 0) by_slot.row(corners[k]) += factor * r.by_slot.col(k).transpose();
  };
  for (const Edge& edge : edges_) {
    const Residual strain = strain_of(edge, moved.positions), bending = bending_of(edge, moved.positions);
    add(edge, strain, strain_share() * soft_absolute_slope(strain.value, softness()));
    add(edge, bending, bending_share() * soft_absolute_slope(bending.value, bending_softness()));
  }
  Points gradient = Points::Zero(control.rows(), 3);
  for (std::size_t s = 0; s < vertices_.size(); ++s)
    for (int i = moved.offsets[s]; i < moved.offsets[s + 1]; ++i)
      gradient.row(moved.entries[i].control) += by_slot.row(s) * moved.entries[i].matrix;
  return gradient;
}

}  // namespace vultus::registration
