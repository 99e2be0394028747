#include "apps/virtual_stage/hair_paint.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/virtual_stage/solid_noise.h"
#include "core/random.h"

namespace vultus::virtual_stage {
namespace {

using V2 = Eigen::Vector2d;

/// Middle line of the left brow and its half width, from the nose to the temple.
struct BrowStation {
  V2 middle;
  double half_width;
};
const std::array<BrowStation, 6> brow_line = {{{V2(11.5, 14.2), 3.4},
                                               {V2(19.0, 16.3), 3.8},
                                               {V2(28.0, 19.4), 3.5},
                                               {V2(37.0, 21.1), 2.9},
                                               {V2(46.0, 20.2), 2.1},
                                               {V2(54.5, 16.4), 0.8}}};

BrowStation brow_at(double t) {
  const double x = std::clamp(t, 0.0, 1.0) * (brow_line.size() - 1);
  const auto i = std::min<std::size_t>(static_cast<std::size_t>(x), brow_line.size() - 2);
  const double f = x - static_cast<double>(i);
  return {(1 - f) * brow_line[i].middle + f * brow_line[i + 1].middle,
          (1 - f) * brow_line[i].half_width + f * brow_line[i + 1].half_width};
}

double ramp(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Height of the front hairline's points and how far forward hair grows there.
const std::array<V2, 10> front_line = {
    {{-14, -62}, {-4, -59.5}, {6, -54}, {17, -46}, {28.5, -37}, {40.5, -28}, {52, -17}, {61, -8}, {68, 3}, {76, 18}}};

double front_line_z(double y) {
  if (y <= front_line.front().x()) return front_line.front().y();
  for (std::size_t i = 1; i < front_line.size(); ++i)
    if (y < front_line[i].x()) {
      const double f = (y - front_line[i - 1].x()) / (front_line[i].x() - front_line[i - 1].x());
      return (1 - f) * front_line[i - 1].y() + f * front_line[i].y();
    }
  return front_line.back().y() + 2.0 * (y - front_line.back().x());
}

/// Signed distance (about, mm) inside the scalp's hair.
double inside_hairline(const Eigen::Vector3d& p) {
  const double front = front_line_z(p.y()) - p.z();
  if (p.y() > 20.0) return front;
  const double sideburn = std::min({front, p.z() + 67.5, p.y() + 13.0});
  const double nape = -60.0 + 0.9 * std::max(0.0, p.z() + 128.0);
  const double behind_ear = std::min(-90.0 - p.z(), p.y() - nape);
  const double low = std::max(sideburn, behind_ear);
  const double above_ear = std::min(front, p.y() - 14.0);
  return std::max(low, above_ear);
}

}  // namespace

EyebrowPaint::EyebrowPaint(std::uint32_t seed) {
  Random random(seed, 7);
  for (int i = 0; i < 420; ++i) {
    const double t = random.uniform(), side = random.uniform(-1.0, 1.0);
    const BrowStation here = brow_at(t), next = brow_at(t + 0.02), before = brow_at(t - 0.02);
    const V2 along = (next.middle - before.middle).normalized(), across(-along.y(), along.x());
    const V2 root = here.middle + 0.85 * side * here.half_width * across;
    // Upright near the nose, lying towards the temple further out; from above down, from below up.
    const double upright = 1.1 * (1.0 - ramp(0.0, 0.35, t)) - 0.28 * side;
    const V2 direction = (along + upright * across).normalized();
    const double length = (4.2 + 2.0 * random.uniform()) * (1.0 - 0.45 * t);
    hairs_.push_back({root, root + length * direction, 0.22 + 0.10 * random.uniform()});
  }
}

double EyebrowPaint::coverage(const Eigen::Vector3d& p) const {
  if (p.y() < 8.0 || p.y() > 34.0 || p.z() < -5.0 || std::abs(p.x()) > 64.0) return 0.0;
  const V2 q(std::abs(p.x()), p.y());
  double bare = 1.0;
  for (const Hair& hair : hairs_) {
    const V2 axis = hair.tip - hair.root;
    const double t = std::clamp((q - hair.root).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
    const double distance = (q - hair.root - t * axis).norm(), width = hair.width * (1.0 - 0.6 * t);
    if (distance < 2.0 * width) bare *= 1.0 - 0.75 * (1.0 - ramp(0.5 * width, 2.0 * width, distance));
  }
  return 1.0 - bare;
}

double scalp_coverage(const Eigen::Vector3d& p, std::uint32_t seed) {
  const double ragged = 2.6 * solid_noise(p / 9.0, seed) + 1.6 * solid_noise(p / 2.2, seed + 1);
  const double inside = inside_hairline(p) + ragged;
  if (inside <= -4.0) return 0.0;
  // Stubble: strands lean back and down, so the pattern is drawn out that way.
  const Eigen::Vector3d strand(p.x() / 0.55, p.y() / 1.3, p.z() / 1.3);
  const double stubble = 0.84 + 0.16 * solid_noise(strand, seed + 2, 2);
  return std::clamp(stubble * ramp(-4.0, 7.0, inside), 0.0, 1.0);
}

}  // namespace vultus::virtual_stage
