#include "apps/virtual_stage/jaw.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace vultus::virtual_stage {
namespace {

constexpr double corner_follows = 0.40;  // share of the jaw's turn that the mouth's corners take part in
constexpr double full_turn = 0.37, full_side = 8.0, full_forward = 6.0;  // radians, mm

Eigen::VectorXd jaw_weight(const FaceFeatures& face) {
  const std::vector<bool> upper = face.members("upper_lip"), lower = face.members("lower_lip"),
                          lips = face.members("lips"), neck = face.members("neck"), back = face.members("back_of_head"),
                          ears = face.members("ears"), eyes = face.members("eyeballs"),
                          teeth_upper = face.members("teeth_upper"), teeth_lower = face.members("teeth_lower");
  const double s = face.scale;
  const Eigen::Vector3d nose = face.at("9.15"), chin = face.at("2.1"), fold = face.at("labiomental"),
                        corner = face.at("2.13"), tragus = face.at("10.9"), throat = face.at("throat_top");
  std::vector<std::pair<int, double>> given;
  for (int v = 0; v < face.topology.vertex_count(); ++v) {
    const Eigen::Vector3d p = face.positions.row(v);
    const double along = along_mouth(face, p.x()), opening = mouth_opening(along);
    // A line from above the nose's wings down to the ear's lobe bounds what the skull holds.
    const double skull_line =
        nose.y() + 4 * s + (tragus.y() - 25 * s - nose.y()) * std::abs(p.x()) / std::abs(tragus.x());
    if (eyes[v] || teeth_upper[v] || back[v] || ears[v])
      given.emplace_back(v, 0.0);
    else if (teeth_lower[v])
      given.emplace_back(v, 1.0);
    else if (upper[v])
      given.emplace_back(v, corner_follows * (1.0 - opening));
    else if (lower[v])
      given.emplace_back(v, corner_follows + (0.97 - corner_follows) * opening);
    else if (lips[v])
      given.emplace_back(v, corner_follows);
    else if (neck[v] && p.y() < throat.y() - 12 * s)
      given.emplace_back(v, 0.0);
    else if (p.z() < corner.z() - 22 * s && p.y() < tragus.y())
      given.emplace_back(v, 0.0);
    else if (p.y() > skull_line)
      given.emplace_back(v, 0.0);
    else if (p.y() < fold.y() && p.y() > chin.y() - 6 * s && p.z() > chin.z() - 28 * s && std::abs(p.x()) < 30 * s)
      given.emplace_back(v, 1.0);
  }
  return face.fields.through(given).cwiseMax(0.0).cwiseMin(1.0);
}

}  // namespace

double along_mouth(const FaceFeatures& face, double x) {
  const double left = face.at("2.4").x(), right = face.at("2.4", Side::right).x();
  return 2.0 * (x - right) / (left - right) - 1.0;
}

double mouth_opening(double along) { return std::pow(std::max(0.0, 1.0 - std::pow(std::abs(along), 2.2)), 0.62); }

JawMotion jaw_motion(const FaceFeatures& face) {
  JawMotion jaw;
  jaw.scale = face.scale;
  const Eigen::Vector3d lobe = 0.5 * (face.at("10.7") + face.at("10.7", Side::right)),
                        top = 0.5 * (face.at("10.9") + face.at("10.9", Side::right));
  jaw.hinge = 0.5 * (lobe + top) + face.scale * Eigen::Vector3d(0, 0, 12);  // the condyles lie in front of the ears
  jaw.weight = jaw_weight(face);
  return jaw;
}

void JawMotion::apply(Points& positions, double open, double left, double forward) const {
  if (open == 0.0 && left == 0.0 && forward == 0.0) return;
  const double glide = 5.0 * open;  // the condyles leave their sockets as the mouth opens
  const Eigen::Vector3d slide =
      scale * Eigen::Vector3d(0.6 * full_side * left, -0.35 * glide, full_forward * forward + glide);
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    const double w = weight[v];
    if (w <= 0.0) continue;
    const Eigen::Vector3d arm = Eigen::Vector3d(positions.row(v)) - hinge;
    // Sideways the jaw swings about one condyle, which turns the chin and lowers the other side a little.
    const Eigen::Quaterniond turn = Eigen::AngleAxisd(w * full_turn * open, Eigen::Vector3d::UnitX()) *
                                    Eigen::AngleAxisd(w * 0.03 * left, Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(w * 0.035 * left, Eigen::Vector3d::UnitY());
    positions.row(v) = (hinge + turn * arm + w * slide).transpose();
  }
}

}  // namespace vultus::virtual_stage
