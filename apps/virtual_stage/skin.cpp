#include "apps/virtual_stage/skin.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "apps/virtual_stage/hair_paint.h"
#include "apps/virtual_stage/solid_noise.h"
#include "core/random.h"
#include "register/template_head.h"

namespace vultus::virtual_stage {
namespace {

using Colour = Eigen::Vector3f;
using V = Eigen::Vector3d;

Colour mix(const Colour& a, const Colour& b, double t) {
  const auto f = static_cast<float>(std::clamp(t, 0.0, 1.0));
  return (1.0f - f) * a + f * b;
}

double ramp(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

double twin_bump(const V& p, const V& centre, const V& r) {
  return std::exp(-0.5 * (V(std::abs(p.x()), p.y(), p.z()) - centre).cwiseQuotient(r).squaredNorm());
}

/// Membership in a named set, 1 or 0 a vertex, interpolated over the surface.
class SetMask {
 public:
  SetMask(const Topology& topology, const std::string& name)
      : triangles_(topology.triangles()), member_(topology.vertex_count(), 0.0) {
    for (const int v : topology.set(name)) member_[v] = 1.0;
  }
  double at(const SurfacePoint& s) const {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) sum += s.barycentric[k] * member_[triangles_(s.triangle, k)];
    return sum;
  }
  bool whole(int triangle) const {
    return member_[triangles_(triangle, 0)] + member_[triangles_(triangle, 1)] + member_[triangles_(triangle, 2)] > 2.5;
  }

 private:
  const Triangles& triangles_;
  std::vector<double> member_;
};

Colour eye_colour(const V& p, const registration::EyeSphere& eye, const Complexion& c) {
  const V d = (p - eye.centre).normalized();
  const double degrees = std::acos(std::clamp(d.z(), -1.0, 1.0)) * 180.0 / M_PI, turn = std::atan2(d.y(), d.x());
  const V ray(6.0 * std::cos(turn), 6.0 * std::sin(turn), 0.08 * degrees);
  const double streak = solid_noise(1.6 * ray, c.seed + 11, 2);
  const double veins = ramp(0.55, 0.9, 1.0 - std::abs(solid_noise(p / 2.5, c.seed + 12, 3)) * 1.6);
  Colour sclera = mix(Colour(0.70f, 0.66f, 0.61f), Colour(0.62f, 0.36f, 0.31f),
                      0.25 * veins * ramp(32, 60, degrees) + 0.35 * ramp(48, 75, degrees));
  Colour iris = c.iris * static_cast<float>(1.05 + 0.45 * streak);
  iris = mix(iris, c.iris.cwiseProduct(Colour(1.5f, 1.15f, 0.7f)), 1.0 - ramp(11, 18, degrees));
  iris = mix(iris, 0.25f * c.iris, ramp(23.0, 27.0, degrees));
  const Colour pupil(0.004f, 0.004f, 0.004f);
  return mix(mix(pupil, iris, ramp(9.2, 10.6, degrees)), sclera, ramp(26.3, 28.6, degrees));
}

Colour tooth_colour(const V& p) {
  const double along = std::abs(p.x()) * (1.0 + 0.006 * std::abs(p.x()));
  const double gap = std::abs(along / 7.2 - std::round(along / 7.2)) * 7.2;
  const double gum = std::max(ramp(-60.5, -58.5, p.y()), 1.0 - ramp(-75.5, -73.5, p.y()));
  const Colour enamel = mix(Colour(0.30f, 0.20f, 0.13f), Colour(0.68f, 0.62f, 0.50f), ramp(0.0, 0.5, gap));
  return mix(enamel, Colour(0.42f, 0.15f, 0.13f), gum);
}

/// Everything that lies on the skin.
class SkinPaint {
 public:
  SkinPaint(const Topology& topology, const Complexion& c)
      : c_(c),
        brows_(c.seed + 3),
        lips_(topology, "lips"),
        cavity_(topology, "mouth_cavity"),
        lining_(topology, "mouth_lining"),
        lids_(topology, "lids"),
        ears_(topology, "ears"),
        nostrils_(topology, "nostrils"),
        margin_left_(topology, "lid_margin_left"),
        margin_right_(topology, "lid_margin_right") {
    Random random(c.seed, 9);
    for (int i = random.below(6); i > 0; --i)
      moles_.push_back(V(random.uniform(-62, 62), random.uniform(-105, 65), random.uniform(0.5, 1.1)));
  }

  Colour at(const SurfacePoint& s, const V& p) const {
    Colour colour = mix(bare(p), c_.lips, 0.9 * ramp(0.15, 0.85, lips_.at(s) + lining_.at(s)) * lip_wear(p));
    colour = mix(colour, c_.flush, 0.25 * lids_.at(s) + 0.5 * ears_.at(s));
    const double margin = margin_left_.at(s) + margin_right_.at(s);
    colour = mix(colour, Colour(0.5f * c_.flush), 0.55 * margin);
    if (margin > 0.0 && p.y() > -1.5)
      colour = mix(colour, Colour(0.25f * c_.hair), 0.92 * ramp(0.1, 0.6, margin));
    else if (margin > 0.0)
      colour = mix(colour, Colour(0.6f * c_.hair), 0.45 * ramp(0.3, 0.8, margin));
    colour = mix(colour, Colour(0.12f * c_.flush), nostrils_.at(s));
    colour = mix(colour, Colour(0.16f, 0.045f, 0.04f), cavity_.at(s));
    colour = mix(colour, c_.hair, 0.94 * brows_.coverage(p));
    if (ears_.at(s) == 0.0) colour = mix(colour, c_.hair, 0.93 * scalp_coverage(p, c_.seed + 4));
    return colour;
  }

 private:
  double lip_wear(const V& p) const {
    return 0.92 + 0.08 * solid_noise(V(p.x() / 0.8, p.y() / 4.0, p.z() / 4.0), c_.seed + 5);
  }

  Colour bare(const V& p) const {
    const double blood =
        0.5 * twin_bump(p, V(40, -32, 14), V(20, 14, 22)) + 0.55 * twin_bump(p, V(0, -38, 50), V(13, 9, 14)) +
        0.35 * twin_bump(p, V(0, -100, 28), V(16, 9, 16)) + 0.25 * twin_bump(p, V(0, 30, 34), V(30, 20, 20));
    const double mottling = solid_noise(p / 11.0, c_.seed, 3);
    Colour colour = mix(c_.skin, c_.flush, blood * (0.9 + 0.5 * mottling) + 0.10 * (mottling + 0.5));
    colour *= static_cast<float>(1.0 + 0.035 * solid_noise(p / 26.0, c_.seed + 6, 2) +
                                 0.05 * solid_noise(p / 0.9, c_.seed + 7, 2));
    const double tired = twin_bump(p, V(29, -12, 16), V(10, 4, 12));
    colour = mix(colour, colour.cwiseProduct(Colour(0.80f, 0.78f, 0.86f)), 0.6 * tired);
    const double spots = solid_noise(p / 2.1, c_.seed + 8) + 0.35 * solid_noise(p / 14.0, c_.seed + 9);
    const double where = twin_bump(p, V(22, -20, 25), V(34, 24, 40));
    colour =
        mix(colour, colour.cwiseProduct(Colour(0.72f, 0.55f, 0.45f)), c_.freckles * where * ramp(0.55, 0.85, spots));
    return mix(colour, colour.cwiseProduct(Colour(0.45f, 0.32f, 0.27f)), 0.75 * mole_at(p));
  }

  double mole_at(const V& p) const {
    if (p.z() < -25.0) return 0.0;
    double strongest = 0.0;
    for (const V& m : moles_)
      strongest = std::max(strongest, 1.0 - ramp(0.6 * m.z(), 1.2 * m.z(), (p - m).head<2>().norm()));
    return strongest;
  }

  Complexion c_;
  EyebrowPaint brows_;
  std::vector<V> moles_;  // x, y seen from the front, radius
  SetMask lips_, cavity_, lining_, lids_, ears_, nostrils_, margin_left_, margin_right_;
};

}  // namespace

Image skin_albedo(const TextureSpace& space, const Points& reference, const Complexion& c) {
  const Topology& topology = space.topology();
  const SkinPaint skin(topology, c);
  const SetMask left(topology, "eyeball_left"), right(topology, "eyeball_right"), teeth(topology, "teeth");
  Image albedo = Image::rgb(space.width(), space.height());
  tbb::parallel_for(0, space.height(), [&](int y) {
    for (int x = 0; x < space.width(); ++x) {
      const SurfacePoint& s = space.at(x, y);
      if (!s.valid()) continue;
      const V p = position_of(s, topology, reference);
      Colour colour;
      if (left.whole(s.triangle))
        colour = eye_colour(p, registration::eye_sphere_left(), c);
      else if (right.whole(s.triangle))
        colour = eye_colour(p, registration::eye_sphere_right(), c);
      else if (teeth.whole(s.triangle))
        colour = tooth_colour(p);
      else
        colour = skin.at(s, p);
      albedo.set_rgb(x, y, colour.cwiseMax(0.0f).cwiseMin(1.0f));
    }
  });
  space.dilate(albedo, 8);
  return albedo;
}

}  // namespace vultus::virtual_stage
