#include "apps/virtual_stage/actor.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "apps/virtual_stage/actor_traits.h"
#include "core/random.h"
#include "register/template_head.h"

namespace vultus::virtual_stage {
namespace {

/// Traits of the eyes, after those of `face_traits`.
enum EyeTrait { eye_spacing, eye_slant, eye_opening };
const std::array<std::string, 3> eye_trait_names = {"eye_spacing", "eye_slant", "eye_opening"};

double smooth_between(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

Eigen::Vector3d face_displacement(const Eigen::Vector3d& p, const Identity& who) {
  Eigen::Vector3d d = Eigen::Vector3d::Zero();
  const auto& traits = face_traits();
  for (std::size_t i = 0; i < traits.size(); ++i) d += who.traits[i] * traits[i].displacement(p);
  const auto& sides = asymmetric_traits();
  for (std::size_t i = 0; i < sides.size(); ++i) d += who.asymmetry[i] * sides[i].displacement(p);
  return d;
}

/// An eye's own motion: the eyeball and what lies on it go rigidly, the skin around follows by distance.
struct EyeMotion {
  Eigen::Vector3d centre, shift;
  double slant, opening;  // radians, about z and about the eyeball's x axis
  double radius;

  double share(const Eigen::Vector3d& p) const {
    return 1.0 - smooth_between(radius + 3.0, radius + 17.0, (p - centre).norm());
  }

  Eigen::Vector3d moved(const Eigen::Vector3d& p, bool lid) const {
    Eigen::Vector3d arm = Eigen::AngleAxisd(slant, Eigen::Vector3d::UnitZ()) * (p - centre);
    if (lid && arm.norm() > 1e-9) {
      // Lids turn about the eyeball, most at the middle of their margin, not at all at the corners and in the crease.
      const double up = arm.y() / arm.norm(), across = arm.x() / radius;
      const double turn = std::clamp(up / 0.35, -1.0, 1.0) * std::clamp((0.95 - std::abs(up)) / 0.45, 0.0, 1.0);
      const double middle = std::max(0.0, 1.0 - across * across);
      arm = Eigen::AngleAxisd(-opening * turn * middle, Eigen::Vector3d::UnitX()) * arm;
    }
    return centre + shift + arm;
  }
};

EyeMotion eye_motion(const registration::EyeSphere& eye, const Identity& who) {
  const double side = eye.centre.x() > 0 ? 1.0 : -1.0;
  const double* own = who.traits.data() + face_traits().size();
  EyeMotion m;
  m.centre = eye.centre;
  m.radius = eye.radius;
  m.shift = face_displacement(eye.centre + Eigen::Vector3d(0, 0, 6), who) +
            Eigen::Vector3d(side * 1.1 * own[eye_spacing], 0, 0);
  m.slant = side * 0.028 * own[eye_slant];
  m.opening = 0.035 * own[eye_opening];
  return m;
}

}  // namespace

const std::string& trait_name(int trait) {
  assert(trait >= 0 && trait < trait_count);
  const int faces = static_cast<int>(face_traits().size());
  return trait < faces ? face_traits()[trait].name : eye_trait_names[trait - faces];
}

Identity random_identity(std::uint64_t seed, double asymmetry) {
  assert(face_traits().size() + eye_trait_names.size() == trait_count);
  Identity who;
  Random random(seed, 101);
  for (double& t : who.traits) t = std::clamp(random.normal(), -2.0, 2.0);
  for (double& t : who.asymmetry) t = asymmetry * std::clamp(random.normal(), -2.0, 2.0);
  return who;
}

Points shaped(const registration::Template& head, const Identity& who) {
  std::vector<bool> lid(head.neutral.rows(), false), ball(head.neutral.rows(), false);
  for (const int v : head.topology->set("lids")) lid[v] = true;
  for (const int v : head.topology->set("eyeballs")) ball[v] = true;
  const EyeMotion left = eye_motion(registration::eye_sphere_left(), who);
  const EyeMotion right = eye_motion(registration::eye_sphere_right(), who);
  Points shape = head.neutral;
  for (int v = 0; v < shape.rows(); ++v) {
    const Eigen::Vector3d p = head.neutral.row(v);
    const EyeMotion& eye = p.x() > 0 ? left : right;
    const double share = ball[v] ? 1.0 : eye.share(p);
    Eigen::Vector3d q = p + face_displacement(p, who);
    if (share > 0.0) q = (1.0 - share) * q + share * eye.moved(p, lid[v]);
    shape.row(v) = q;
  }
  return shape;
}

Points identity(const registration::Template& head, std::uint64_t seed) { return shaped(head, random_identity(seed)); }

}  // namespace vultus::virtual_stage
