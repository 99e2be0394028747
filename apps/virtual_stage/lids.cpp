#include "apps/virtual_stage/lids.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>

namespace vultus::virtual_stage {
namespace {

using Profile = std::vector<std::pair<double, double>>;  // x → angle

struct Sphere {
  Eigen::Vector3d centre;
  double radius;
};

// Linear least squares: |p|² = 2 c·p + (r² − |c|²).
Sphere fitted_sphere(const Points& positions, const std::vector<int>& vertices) {
  Eigen::MatrixXd left(vertices.size(), 4);
  Eigen::VectorXd right(vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Eigen::Vector3d p = positions.row(vertices[i]);
    left.row(i) << 2.0 * p.transpose(), 1.0;
    right[i] = p.squaredNorm();
  }
  const Eigen::Vector4d s = left.colPivHouseholderQr().solve(right);
  const Eigen::Vector3d centre = s.head<3>();
  return {centre, std::sqrt(s[3] + centre.squaredNorm())};
}

double elevation(const LidMotion& lids, const Eigen::Vector3d& position) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ().cross(lids.axis).normalized();
  const Eigen::Vector3d from_centre = position - lids.centre;
  return std::atan2(from_centre.dot(up), from_centre.z());
}

Profile margin(const FaceFeatures& face, const LidMotion& lids, const std::string& set) {
  Profile profile;
  for (const int v : face.line(set)) {
    const Eigen::Vector3d p = face.positions.row(v);
    profile.emplace_back(p.x(), elevation(lids, p));
  }
  return profile;
}

bool between_ends(const Profile& profile, double x) { return x > profile.front().first && x < profile.back().first; }

// Vertices of the lids' sets that touch others: the crease, where the lid's skin folds into the orbit's.
std::vector<bool> crease(const FaceFeatures& face) {
  const std::vector<bool> lid = face.members("lids");
  std::vector<bool> rim(face.topology.vertex_count(), false);
  const Triangles& triangles = face.topology.triangles();
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const bool mixed = !(lid[triangles(t, 0)] && lid[triangles(t, 1)] && lid[triangles(t, 2)]);
    for (int c = 0; c < 3 && mixed; ++c) rim[triangles(t, c)] = lid[triangles(t, c)];
  }
  return rim;
}

constexpr double closing_height = 0.16;  // of the opening, where the lids meet: the upper does most of the way

std::string side_name(Side side) { return side == Side::left ? "left" : "right"; }

// Angle field of one lid: `travel` at its margin and behind it, a remainder at the crease, 0 beyond the orbit.
Eigen::VectorXd lid_field(const FaceFeatures& face, const LidMotion& lids, const std::string& set,
                          const std::string& other_set, const Profile& own_margin, const Profile& other_margin,
                          bool is_upper, double crease_share) {
  std::vector<bool> lid = face.members(set);
  const std::vector<bool> any_lid = face.members("lids"), rim = crease(face), other = face.members(other_set);
  const double to_line = is_upper ? 1.0 - closing_height : closing_height;
  std::vector<std::pair<int, double>> given;
  for (int v = 0; v < face.topology.vertex_count(); ++v) {
    const Eigen::Vector3d p = face.positions.row(v);
    const double reach = (p - lids.centre).norm();
    const bool near = any_lid[v] && reach < 2.5 * lids.radius;
    const double x = p.x();
    const double travel = between_ends(own_margin, x)
                              ? to_line * std::abs(interpolate(own_margin, x) - interpolate(other_margin, x))
                              : 0.0;
    const double angle = elevation(lids, p), edge = interpolate(own_margin, x);
    // Towards the eye's corners vertices are in neither lid's set: the nearer margin takes them.
    const double middle = 0.5 * (edge + interpolate(other_margin, x));
    if (any_lid[v] && !lid[v] && !other[v]) lid[v] = is_upper ? angle > middle : angle < middle;
    constexpr double tolerance = 0.03;  // radians
    const bool at_margin =
        reach < lids.radius + 1.0 || (is_upper ? angle < edge + tolerance : angle > edge - tolerance);
    if (!near)
      given.emplace_back(v, 0.0);
    else if (lid[v] && at_margin)
      given.emplace_back(v, travel);
    else if (!lid[v])
      given.emplace_back(v, 0.0);
    else if (rim[v])
      given.emplace_back(v, crease_share * travel);
  }
  return face.fields.through(given);
}

}  // namespace

LidMotion lid_motion(const FaceFeatures& face, Side side) {
  LidMotion lids;
  const std::string name = side_name(side);
  const Sphere eye = fitted_sphere(face.positions, face.topology.set("eyeball_" + name));
  lids.centre = eye.centre;
  lids.radius = eye.radius;
  Eigen::Vector3d along = face.at("3.7", side) - face.at("3.11", side);
  along.z() = 0.0;
  lids.axis = (along.x() < 0 ? Eigen::Vector3d(-along) : along).normalized();

  const Profile upper = margin(face, lids, "lid_line_upper_" + name),
                lower = margin(face, lids, "lid_line_lower_" + name);
  const Eigen::VectorXd down =
      lid_field(face, lids, "upper_lid_" + name, "lower_lid_" + name, upper, lower, true, 0.22);
  const Eigen::VectorXd rise =
      lid_field(face, lids, "lower_lid_" + name, "upper_lid_" + name, lower, upper, false, 0.3);
  std::vector<double> u, l, c;
  for (int v = 0; v < face.topology.vertex_count(); ++v) {
    constexpr double still = 1e-4;  // radians
    if (std::abs(down[v]) < still && std::abs(rise[v]) < still) continue;
    lids.vertices.push_back(v);
    u.push_back(down[v]);
    l.push_back(rise[v]);
    c.push_back(std::min((Eigen::Vector3d(face.positions.row(v)) - lids.centre).norm(), lids.radius + 1.2));
  }
  lids.upper = Eigen::Map<Eigen::VectorXd>(u.data(), u.size());
  lids.lower = Eigen::Map<Eigen::VectorXd>(l.data(), l.size());
  lids.clearance = Eigen::Map<Eigen::VectorXd>(c.data(), c.size());
  return lids;
}

void LidMotion::apply(Points& positions, double upper_closed, double lower_closed) const {
  if (upper_closed == 0.0 && lower_closed == 0.0) return;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const double rise = lower[i] * std::min(lower_closed, 1.0) - upper[i] * std::min(upper_closed, 1.0);
    Eigen::Vector3d arm = Eigen::Vector3d(positions.row(vertices[i])) - centre;
    arm = Eigen::AngleAxisd(-rise, axis) * arm;
    if (arm.norm() < clearance[i]) arm *= clearance[i] / arm.norm();
    positions.row(vertices[i]) = (centre + arm).transpose();
  }
}

Eigen::VectorXd lid_hold(const FaceFeatures& face) {
  std::vector<std::pair<int, double>> given;
  const std::vector<bool> lid = face.members("lids"), rim = crease(face);
  std::vector<bool> line(face.topology.vertex_count(), false);
  for (const char* set : {"lid_line_upper_left", "lid_line_lower_left", "lid_line_upper_right", "lid_line_lower_right"})
    for (const int v : face.topology.set(set)) line[v] = true;
  const Sphere eyes[2] = {fitted_sphere(face.positions, face.topology.set("eyeball_left")),
                          fitted_sphere(face.positions, face.topology.set("eyeball_right"))};
  for (int v = 0; v < face.topology.vertex_count(); ++v) {
    const Eigen::Vector3d p = face.positions.row(v);
    const Sphere& eye = eyes[p.x() > 0 ? 0 : 1];
    const bool inside = lid[v] && (p - eye.centre).norm() < eye.radius + 1.0;
    if (line[v] || inside) given.emplace_back(v, 1.0);
    if (!lid[v])
      given.emplace_back(v, 0.0);
    else if (rim[v])
      given.emplace_back(v, 0.35);
  }
  return face.fields.through(given).cwiseMax(0.0).cwiseMin(1.0);
}

}  // namespace vultus::virtual_stage
