#include "apps/virtual_stage/actor_traits.h"

#include <algorithm>
#include <cmath>

namespace vultus::virtual_stage {
namespace {

using V = Eigen::Vector3d;

/// 1 at the centre, falling off with deviations `r` along each axis.
double bump(const V& p, const V& centre, const V& r) {
  return std::exp(-0.5 * (p - centre).cwiseQuotient(r).squaredNorm());
}

/// The same on both sides: centred at (±x, y, z).
double twin_bump(const V& p, const V& centre, const V& r) { return bump(V(std::abs(p.x()), p.y(), p.z()), centre, r); }

double ramp(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Direction away from the midline that passes smoothly through zero there.
double outward(double x) { return std::tanh(x / 12.0); }

/// Height of the line where the lips meet.
constexpr double lip_line = -67.0;

/// Away from the lip line, zero on it; `reach` mm beyond which it stays constant.
double from_lip_line(double y, double reach) { return std::tanh((y - lip_line) / reach) * reach; }

V wide(double x) { return {x, 0, 0}; }
V high(double y) { return {0, y, 0}; }
V deep(double z) { return {0, 0, z}; }

}  // namespace

const std::vector<Trait>& face_traits() {
  static const std::vector<Trait> traits = {
      {"head_width", [](const V& p) { return wide(0.034 * p.x()); }},
      {"head_length", [](const V& p) { return deep(-0.036 * std::max(0.0, 15.0 - p.z()) * ramp(15, -40, p.z())); }},
      {"size", [](const V& p) -> V { return 0.018 * (p - V(0, 0, -40)); }},
      {"lower_face_height",
       [](const V& p) { return high(0.045 * p.y() * ramp(-25, -75, p.y()) * ramp(-170, -110, p.y())); }},
      {"forehead_height", [](const V& p) { return high(0.05 * (p.y() - 20) * ramp(15, 60, p.y())); }},
      {"forehead_slope", [](const V& p) { return deep(-0.07 * std::max(0.0, p.y() - 25) * ramp(-90, 10, p.z())); }},
      {"jaw_width", [](const V& p) { return wide(0.055 * p.x() * bump(p, V(0, -78, -35), V(1e3, 24, 42))); }},
      {"jaw_height", [](const V& p) { return high(-4.5 * twin_bump(p, V(52, -76, -46), V(22, 20, 26))); }},
      {"chin_width", [](const V& p) { return wide(0.11 * p.x() * bump(p, V(0, -102, 18), V(60, 14, 24))); }},
      {"chin_projection", [](const V& p) { return deep(2.6 * bump(p, V(0, -100, 26), V(20, 14, 26))); }},
      {"chin_height", [](const V& p) { return high(-2.6 * bump(p, V(0, -108, 18), V(26, 15, 30))); }},
      {"nose_length", [](const V& p) { return high(-2.0 * bump(p, V(0, -40, 38), V(17, 13, 20))); }},
      {"nose_width", [](const V& p) { return wide(0.10 * p.x() * bump(p, V(0, -40, 36), V(20, 9, 20))); }},
      {"nose_projection", [](const V& p) { return deep(2.0 * bump(p, V(0, -38, 48), V(10, 13, 16))); }},
      {"nose_tip", [](const V& p) { return high(1.5 * bump(p, V(0, -38, 49), V(8, 8, 9))); }},
      {"nose_bridge", [](const V& p) { return deep(1.6 * bump(p, V(0, -3, 28), V(7, 13, 10))); }},
      {"nose_hump", [](const V& p) { return deep(1.1 * bump(p, V(0, -16, 36), V(7, 7, 10))); }},
      {"nose_bridge_width", [](const V& p) { return wide(0.12 * p.x() * bump(p, V(0, -10, 30), V(10, 15, 10))); }},
      {"brow_ridge", [](const V& p) { return deep(1.5 * twin_bump(p, V(22, 22, 28), V(20, 7, 14))); }},
      {"brow_height", [](const V& p) { return high(1.7 * twin_bump(p, V(33, 23, 24), V(17, 8, 20))); }},
      {"cheekbones",
       [](const V& p) -> V {
         return 2.0 * twin_bump(p, V(55, -19, 4), V(15, 11, 18)) * V(0.75 * outward(p.x()), 0, 0.66);
       }},
      {"cheek_fullness",
       [](const V& p) -> V {
         return 2.4 * twin_bump(p, V(48, -52, 4), V(17, 17, 22)) * V(0.75 * outward(p.x()), 0, 0.5);
       }},
      {"mouth_width", [](const V& p) { return wide(0.055 * p.x() * bump(p, V(0, -68, 30), V(30, 13, 20))); }},
      {"lip_height",
       [](const V& p) { return high(0.11 * from_lip_line(p.y(), 9.0) * bump(p, V(0, -68, 36), V(20, 10, 12))); }},
      {"lip_fullness", [](const V& p) { return deep(1.0 * bump(p, V(0, -67.5, 38), V(15, 8, 9))); }},
      {"mouth_projection", [](const V& p) { return deep(1.3 * bump(p, V(0, -68, 34), V(24, 18, 30))); }},
      {"ear_size",
       [](const V& p) -> V {
         return 0.07 * ramp(68, 73, std::abs(p.x())) * bump(p, V(p.x(), -14, -80), V(1, 28, 22)) *
                (p - V(std::copysign(70.0, p.x()), -14, -70));
       }},
      {"neck_width",
       [](const V& p) -> V {
         const double s = 0.05 * ramp(-85, -135, p.y());
         return {s * p.x(), 0, s * (p.z() + 82)};
       }},
  };
  return traits;
}

const std::vector<Trait>& asymmetric_traits() {
  static const std::vector<Trait> traits = {
      {"nose", [](const V& p) { return wide(0.6 * bump(p, V(0, -36, 44), V(14, 14, 16))); }},
      {"eye_height",
       [](const V& p) { return high(0.35 * std::tanh(p.x() / 25) * bump(p, V(0, 5, 15), V(70, 25, 30))); }},
      {"jaw", [](const V& p) { return wide(0.8 * bump(p, V(0, -100, 10), V(50, 28, 50))); }},
      {"mouth_corners",
       [](const V& p) { return high(0.5 * std::tanh(p.x() / 15) * bump(p, V(0, -68, 28), V(30, 14, 20))); }},
      {"cheeks",
       [](const V& p) { return wide(0.6 * bump(p, V(0, -40, 0), V(80, 25, 40)) * std::tanh(std::abs(p.x()) / 30)); }},
  };
  return traits;
}

}  // namespace vultus::virtual_stage
