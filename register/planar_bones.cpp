#include "register/planar_bones.h"

#include <ceres/jet.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "core/error.h"

namespace vultus::registration {
namespace {

using Region = BoneBinding::Region;
template <typename T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

// Weights are held to this many bones a vertex; only skin far from all bones has more.
constexpr std::size_t most_bones = 24;
// Where skin out of reach stands in the fall-off of its nearest bone.
constexpr double far_standing = 0.5;

int next(int i) { return (i + 1) % 3; }
int previous(int i) { return (i + 2) % 3; }

/// Corners O, P, Q of a bone, its edges e_i, the unit normal, and the unit directions e_i × n out of each edge.
template <typename T>
struct Frame {
  std::array<Vector3<T>, 3> corner, edge, out;
  Vector3<T> normal;

  explicit Frame(const std::array<Vector3<T>, 3>& corners) : corner(corners) {
    for (int i = 0; i < 3; ++i) edge[i] = corner[next(i)] - corner[i];
    const Vector3<T> doubled = edge[2].cross(edge[0]);
    // The tiny number keeps a bone that collapses on the way from making a NaN.
    normal = doubled / sqrt(doubled.squaredNorm() + T(1e-20));
    for (int i = 0; i < 3; ++i) out[i] = edge[i].cross(normal) / sqrt(edge[i].squaredNorm() + T(1e-20));
  }

  // Eqs. 1, 9 and 10.
  Vector3<T> place(const BoneBinding& at) const {
    using std::sqrt;
    const T a(at.local[0]), b(at.local[1]), height(at.local[2]);
    const int i = at.corner;
    Vector3<T> arm;
    if (at.region == Region::face) {
      arm = edge[0] * a - edge[2] * b;
    } else if (at.region == Region::edge) {
      arm = edge[i] * a + out[i] * b;
    } else {
      arm = out[i] * a + out[previous(i)] * b;
      if (at.in_plane > 0.0) arm *= T(at.in_plane) / sqrt(arm.squaredNorm() + T(1e-20));
    }
    return corner[i] + arm + normal * height;
  }
};

std::array<Eigen::Vector3d, 3> corners_of(const Points& control, const Triangles& triangles, int bone) {
  return {control.row(triangles(bone, 0)).transpose(), control.row(triangles(bone, 1)).transpose(),
          control.row(triangles(bone, 2)).transpose()};
}

std::vector<Frame<double>> frames_of(const Points& control, const Triangles& triangles) {
  std::vector<Frame<double>> frames;
  frames.reserve(triangles.rows());
  for (int j = 0; j < triangles.rows(); ++j) frames.emplace_back(corners_of(control, triangles, j));
  return frames;
}

// Arc length along edge i, mm (c_i of eq. 6).
double along(const Frame<double>& frame, int i, const Eigen::Vector3d& s) {
  return (s - frame.corner[i]).dot(frame.edge[i].normalized());
}

// Eq. 3, then 4 and 5: which region of the bone s lies in.
void classify(const Frame<double>& frame, const Eigen::Vector3d& s, BoneBinding& at) {
  const Eigen::Vector3d arm = s - frame.corner[0];
  const Eigen::Vector3d doubled = frame.edge[2].cross(frame.edge[0]);
  const double area = doubled.norm();
  // s − O = u (P − O) + v (Q − O) + height, and w = u + v.
  const double u = arm.cross(-frame.edge[2]).dot(frame.normal) / area;
  const double v = frame.edge[0].cross(arm).dot(frame.normal) / area;
  const double w = u + v;
  if (u >= 0.0 && v >= 0.0 && w <= 1.0) {
    at.region = Region::face;
    at.corner = 0;
    return;
  }
  const bool beyond[3] = {v<0.0, w> 1.0, u < 0.0};  // edges OP, PQ, QO
  for (int i = 0; i < 3; ++i)
    if (beyond[previous(i)] && beyond[i]) {  // eq. 5, candidate apex i
      at.corner = i;
      if (along(frame, previous(i), s) <= frame.edge[previous(i)].norm()) {
        at.region = Region::edge;
        at.corner = previous(i);
      } else {
        at.region = along(frame, i, s) < 0.0 ? Region::apex : Region::edge;
      }
      return;
    }
  const int i = beyond[0] ? 0 : beyond[1] ? 1 : 2;  // eq. 4, candidate edge i
  const double c = along(frame, i, s);
  at.region = c >= 0.0 && c <= frame.edge[i].norm() ? Region::edge : Region::apex;
  at.corner = c > frame.edge[i].norm() ? next(i) : i;
}

// Fills the binding of s to a bone; returns its distance from the bone, mm.
double place_in(const Frame<double>& frame, const Eigen::Vector3d& s, BoneBinding& at) {
  classify(frame, s, at);
  const Eigen::Vector3d arm = s - frame.corner[at.corner];
  Eigen::Matrix3d basis;
  if (at.region == Region::face)
    basis << frame.edge[0], -frame.edge[2], frame.normal;
  else if (at.region == Region::edge)
    basis << frame.edge[at.corner], frame.out[at.corner], frame.normal;
  else
    basis << frame.out[at.corner], frame.out[previous(at.corner)], frame.normal;
  at.local = basis.inverse() * arm;
  const double height = at.local[2];
  at.in_plane = 0.0;
  if (at.region == Region::face) return std::abs(height);
  if (at.region == Region::edge) return std::hypot(at.local[1], height);
  at.in_plane = (arm - height * frame.normal).norm();
  return arm.norm();
}

// Distance of each bone from the nearest control point joined to it by an edge; for a bone on its own, its longest
// edge.
std::vector<double> clearances(const ControlSurface& surface, const std::vector<Frame<double>>& frames) {
  std::vector<std::vector<int>> joined(surface.rest.rows());
  for (int j = 0; j < surface.triangles.rows(); ++j)
    for (int k = 0; k < 3; ++k)
      for (int other : {next(k), previous(k)}) joined[surface.triangles(j, k)].push_back(surface.triangles(j, other));
  std::vector<double> clearance(frames.size());
  for (std::size_t j = 0; j < frames.size(); ++j) {
    const auto corners = surface.triangles.row(j);
    double nearest = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k)
      for (int point : joined[corners[k]]) {
        if ((corners.array() == point).any()) continue;
        BoneBinding ignored;
        nearest = std::min(nearest, place_in(frames[j], surface.rest.row(point), ignored));
      }
    if (!std::isfinite(nearest))
      nearest = std::max({frames[j].edge[0].norm(), frames[j].edge[1].norm(), frames[j].edge[2].norm()});
    // Control points that fold onto a bone must not leave it without any influence.
    clearance[j] = std::max(nearest, 0.1 * frames[j].edge[0].norm());
  }
  return clearance;
}

void check(const ControlSurface& surface, const Points& vertices, const BoneMasks& masks) {
  if (surface.triangles.rows() == 0) throw InputError("planar bones: the control surface has no triangle");
  if (surface.triangles.minCoeff() < 0 || surface.triangles.maxCoeff() >= surface.rest.rows())
    throw InputError("planar bones: a triangle names a control point that does not exist");
  for (int j = 0; j < surface.triangles.rows(); ++j) {
    const auto c = corners_of(surface.rest, surface.triangles, j);
    const double longest = std::max({(c[1] - c[0]).norm(), (c[2] - c[1]).norm(), (c[0] - c[2]).norm()});
    if (!((c[1] - c[0]).cross(c[2] - c[0]).norm() > 1e-6 * longest * longest))
      throw InputError("planar bones: triangle " + std::to_string(j) + " of the control surface has no area");
  }
  const bool masked = !masks.bones.empty() || !masks.barred.empty();
  if (masked && (masks.bones.size() != static_cast<std::size_t>(surface.triangles.rows()) ||
                 masks.barred.size() != static_cast<std::size_t>(vertices.rows())))
    throw InputError("planar bones: masks need one entry for each bone and each vertex");
}

/// What skin is bound to: the bones at rest.
struct RestBones {
  std::vector<Frame<double>> frames;
  std::vector<double> radii;
  std::vector<std::uint32_t> sides;
  bool everywhere;

  // A bone stands at least this far out in its own fall-off; most need no closer look.
  double least_standing(std::size_t j, const Eigen::Vector3d& s) const {
    const auto& corner = frames[j].corner;
    const Eigen::Vector3d centre = (corner[0] + corner[1] + corner[2]) / 3.0;
    const double size = std::sqrt(std::max(
        {(corner[0] - centre).squaredNorm(), (corner[1] - centre).squaredNorm(), (corner[2] - centre).squaredNorm()}));
    return ((s - centre).norm() - size) / radii[j];
  }
};

// Bones that move s, with the weights of eq. 12.
std::vector<BoneBinding> bindings_of(const RestBones& bones, const Eigen::Vector3d& s, std::uint32_t barred) {
  std::vector<std::pair<double, int>> near;
  for (std::size_t j = 0; j < bones.frames.size(); ++j)
    if (!(bones.sides[j] & barred)) near.emplace_back(bones.least_standing(j, s), static_cast<int>(j));
  std::sort(near.begin(), near.end());
  double nearest = std::numeric_limits<double>::infinity(), limit = 1.0;
  std::vector<BoneBinding> found;
  for (const auto& [least, j] : near) {
    if (least >= limit && (!bones.everywhere || least >= nearest / far_standing)) break;
    BoneBinding at;
    at.bone = j;
    at.weight = place_in(bones.frames[j], s, at) / bones.radii[j];
    nearest = std::min(nearest, at.weight);
    found.push_back(at);
  }
  if (bones.everywhere && nearest > far_standing) limit = nearest / far_standing;
  std::erase_if(found, [&](const BoneBinding& at) { return !(at.weight < limit); });
  for (BoneBinding& at : found) at.weight = 0.5 * (1.0 + std::cos(M_PI * at.weight / limit));
  if (found.size() > most_bones) {
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.weight > b.weight; });
    found.resize(most_bones);
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.bone < b.bone; });
  double sum = 0.0;
  for (const BoneBinding& at : found) sum += at.weight;
  if (!bones.everywhere) sum = std::max(1.0, sum);
  for (BoneBinding& at : found) at.weight /= sum;
  return found;
}

}  // namespace

void PlanarBoneOptions::validate() const {
  if (!(reach > 0.0 && reach <= 1.0)) throw InputError("planar bones: the reach must lie in (0, 1]");
}

PlanarBones::PlanarBones(ControlSurface surface, const Points& vertices, const BoneMasks& masks,
                         const PlanarBoneOptions& options)
    : surface_(std::move(surface)), rest_(vertices) {
  options.validate();
  check(surface_, vertices, masks);
  RestBones bones{frames_of(surface_.rest, surface_.triangles), {}, masks.bones, options.everywhere};
  bones.radii = clearances(surface_, bones.frames);
  for (double& radius : bones.radii) radius *= options.reach;
  if (bones.sides.empty()) bones.sides.assign(surface_.triangles.rows(), 0u);
  std::vector<std::vector<BoneBinding>> found(vertices.rows());
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t v) {
    found[v] = bindings_of(bones, vertices.row(v), masks.barred.empty() ? 0u : masks.barred[v]);
  });
  radii_ = bones.radii;
  offsets_.push_back(0);
  for (const auto& of_vertex : found) {
    double sum = 0.0;
    for (const BoneBinding& at : of_vertex) sum += at.weight;
    at_rest_.push_back(std::max(0.0, 1.0 - sum));
    bindings_.insert(bindings_.end(), of_vertex.begin(), of_vertex.end());
    offsets_.push_back(static_cast<int>(bindings_.size()));
  }
}

std::vector<int> PlanarBones::controls_of(int vertex) const {
  std::vector<int> controls;
  for (const BoneBinding& at : bindings(vertex))
    for (int k = 0; k < 3; ++k) controls.push_back(surface_.triangles(at.bone, k));
  std::sort(controls.begin(), controls.end());
  controls.erase(std::unique(controls.begin(), controls.end()), controls.end());
  return controls;
}

Points PlanarBones::operator()(const Points& control) const {
  std::vector<int> all(rest_.rows());
  std::iota(all.begin(), all.end(), 0);
  return (*this)(control, all);
}

Points PlanarBones::operator()(const Points& control, std::span<const int> vertices) const {
  if (control.rows() != surface_.rest.rows())
    throw InputError("planar bones: " + std::to_string(surface_.rest.rows()) + " control points expected, " +
                     std::to_string(control.rows()) + " given");
  const std::vector<Frame<double>> frames = frames_of(control, surface_.triangles);
  Points positions(vertices.size(), 3);
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    Eigen::Vector3d s = at_rest_[vertices[k]] * rest_.row(vertices[k]).transpose();
    for (const BoneBinding& at : bindings(vertices[k])) s += at.weight * frames[at.bone].place(at);
    positions.row(k) = s;
  }
  return positions;
}

PlanarBones::Derivatives PlanarBones::derivatives(const Points& control, std::span<const int> vertices) const {
  using Jet = ceres::Jet<double, 9>;  // by x, y, z of O, P, Q
  std::vector<Frame<Jet>> frames;
  frames.reserve(surface_.triangles.rows());
  for (int j = 0; j < surface_.triangles.rows(); ++j) {
    std::array<Vector3<Jet>, 3> corners;
    for (int k = 0; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis)
        corners[k][axis] = Jet(control(surface_.triangles(j, k), axis), 3 * k + axis);
    frames.emplace_back(corners);
  }
  Derivatives result;
  result.positions.resize(vertices.size(), 3);
  result.offsets.push_back(0);
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const int v = vertices[k];
    const std::size_t first = result.entries.size();
    for (int c : controls_of(v)) result.entries.push_back({c, Eigen::Matrix3d::Zero()});
    auto entry = [&](int c) -> Eigen::Matrix3d& {
      return std::lower_bound(result.entries.begin() + first, result.entries.end(), c,
                              [](const Derivative& d, int wanted) { return d.control < wanted; })
          ->matrix;
    };
    Eigen::Vector3d s = at_rest_[v] * rest_.row(v).transpose();
    for (const BoneBinding& at : bindings(v)) {
      const Vector3<Jet> place = frames[at.bone].place(at);
      for (int corner = 0; corner < 3; ++corner) {
        Eigen::Matrix3d& matrix = entry(surface_.triangles(at.bone, corner));
        for (int axis = 0; axis < 3; ++axis)
          matrix.row(axis) += at.weight * place[axis].v.segment<3>(3 * corner).transpose();
      }
      for (int axis = 0; axis < 3; ++axis) s[axis] += at.weight * place[axis].a;
    }
    result.positions.row(k) = s;
    result.offsets.push_back(static_cast<int>(result.entries.size()));
  }
  return result;
}

}  // namespace vultus::registration
