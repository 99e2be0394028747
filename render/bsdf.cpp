#include "render/bsdf.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "render/coat_albedo.h"

namespace vultus::render {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

/// Normal distribution (Walter et al. 2007, eq. 33).
float ggx(const Eigen::Vector3f& h, float alpha) {
  const float a2 = alpha * alpha;
  const float s = (h.x() * h.x() + h.y() * h.y()) / a2 + h.z() * h.z();
  return 1.0f / (pi * a2 * s * s);
}

/// Smith's Λ (Heitz 2014, eq. 72).
float lambda(const Eigen::Vector3f& w, float alpha) {
  const float tan2 = (w.x() * w.x() + w.y() * w.y()) / (w.z() * w.z());
  return 0.5f * (std::sqrt(1.0f + alpha * alpha * tan2) - 1.0f);
}

float schlick(float f0, float f90, float cosine) {
  const float m = std::clamp(1.0f - cosine, 0.0f, 1.0f), m2 = m * m;
  return f0 + (f90 - f0) * m2 * m2 * m;
}

}  // namespace

float alpha_from_roughness(float roughness) { return std::max(roughness * roughness, 1e-3f); }

float f0_from_ior(float ior) {
  const float ratio = (ior - 1.0f) / (ior + 1.0f);
  return ratio * ratio;
}

Eigen::Vector3f sample_visible_normal(const Eigen::Vector3f& wo, float alpha, const Eigen::Vector2f& u) {
  const Eigen::Vector3f stretched = Eigen::Vector3f(alpha * wo.x(), alpha * wo.y(), wo.z()).normalized();
  const float flat2 = stretched.x() * stretched.x() + stretched.y() * stretched.y();
  const Eigen::Vector3f t1 = flat2 > 0.0f ? Eigen::Vector3f(-stretched.y(), stretched.x(), 0.0f) / std::sqrt(flat2)
                                          : Eigen::Vector3f(1.0f, 0.0f, 0.0f);
  const Eigen::Vector3f t2 = stretched.cross(t1);
  const float r = std::sqrt(u.x()), phi = 2 * pi * u.y();
  const float x = r * std::cos(phi), s = 0.5f * (1.0f + stretched.z());
  const float y = (1.0f - s) * std::sqrt(std::max(0.0f, 1.0f - x * x)) + s * r * std::sin(phi);
  const Eigen::Vector3f n = x * t1 + y * t2 + std::sqrt(std::max(0.0f, 1.0f - x * x - y * y)) * stretched;
  return Eigen::Vector3f(alpha * n.x(), alpha * n.y(), std::max(1e-6f, n.z())).normalized();
}

float visible_normal_pdf(const Eigen::Vector3f& wo, const Eigen::Vector3f& h, float alpha) {
  if (wo.z() <= 0.0f || h.z() <= 0.0f) return 0.0f;
  return ggx(h, alpha) * std::max(0.0f, wo.dot(h)) / ((1.0f + lambda(wo, alpha)) * wo.z());
}

float Bsdf::coat_albedo(float mu) const {
  const CoatAlbedo e = render::coat_albedo(mu, alpha);
  return f0 * e.a + f90 * e.b;
}

float Bsdf::mean_coat_albedo() const {
  const CoatAlbedo e = render::mean_coat_albedo(alpha);
  return f0 * e.a + f90 * e.b;
}

Eigen::Vector3f Bsdf::value(const Eigen::Vector3f& wo, const Eigen::Vector3f& wi) const {
  if (wo.z() <= 0.0f || wi.z() <= 0.0f) return Eigen::Vector3f::Zero();
  if (f90 <= 0.0f && f0 <= 0.0f) return albedo / pi;
  const Eigen::Vector3f h = (wo + wi).normalized();
  const float masking = 1.0f / (1.0f + lambda(wo, alpha) + lambda(wi, alpha));
  const float coat = ggx(h, alpha) * schlick(f0, f90, wo.dot(h)) * masking / (4.0f * wo.z() * wi.z());
  const float through = (1.0f - coat_albedo(wo.z())) * (1.0f - coat_albedo(wi.z())) /
                        std::max(1.0f - mean_coat_albedo(), 1e-4f);
  return albedo * (through / pi) + Eigen::Vector3f::Constant(coat);
}

float Bsdf::coat_probability(const Eigen::Vector3f& wo) const {
  if (f90 <= 0.0f && f0 <= 0.0f) return 0.0f;
  const float coat = coat_albedo(std::max(wo.z(), 0.0f)), base = (1.0f - coat) * albedo.maxCoeff();
  if (base <= 0.0f) return 1.0f;
  return std::clamp(coat / (coat + base), 0.1f, 0.9f);
}

float Bsdf::pdf(const Eigen::Vector3f& wo, const Eigen::Vector3f& wi) const {
  if (wo.z() <= 0.0f || wi.z() <= 0.0f) return 0.0f;
  const float coat = coat_probability(wo);
  float result = (1.0f - coat) * wi.z() / pi;
  if (coat > 0.0f) {
    const Eigen::Vector3f h = (wo + wi).normalized();
    const float oh = wo.dot(h);
    if (oh > 0.0f) result += coat * visible_normal_pdf(wo, h, alpha) / (4.0f * oh);
  }
  return result;
}

Eigen::Vector3f Bsdf::sample(const Eigen::Vector3f& wo, float choice, const Eigen::Vector2f& u) const {
  if (choice < coat_probability(wo)) {
    const Eigen::Vector3f h = sample_visible_normal(wo, alpha, u);
    return 2.0f * wo.dot(h) * h - wo;
  }
  const float r = std::sqrt(u.x()), phi = 2 * pi * u.y();
  return {r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(0.0f, 1.0f - u.x()))};
}

}  // namespace vultus::render
