#include "render/bsdf.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

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

Bsdf::Bsdf(const Skin& skin, const Eigen::Vector3f& wo) : skin_(skin), wo_(wo) {
  has_coat_ = skin.f0 > 0.0f || skin.f90 > 0.0f;
  if (!has_coat_ || wo.z() <= 0.0f) return;
  const CoatAlbedo towards = render::coat_albedo(wo.z(), skin.alpha), mean = mean_coat_albedo(skin.alpha);
  lambda_o_ = lambda(wo, skin.alpha);
  coat_albedo_ = skin.f0 * towards.a + skin.f90 * towards.b;
  base_scale_ = (1.0f - coat_albedo_) / std::max(1.0f - skin.f0 * mean.a - skin.f90 * mean.b, 1e-4f);
  const float base = (1.0f - coat_albedo_) * skin.albedo.maxCoeff();
  coat_probability_ = base > 0.0f ? std::clamp(coat_albedo_ / (coat_albedo_ + base), 0.1f, 0.9f) : 1.0f;
}

Eigen::Vector3f Bsdf::value(const Eigen::Vector3f& wi) const {
  if (wo_.z() <= 0.0f || wi.z() <= 0.0f) return Eigen::Vector3f::Zero();
  if (!has_coat_) return skin_.albedo / pi;
  const Eigen::Vector3f h = (wo_ + wi).normalized();
  const float masking = 1.0f / (1.0f + lambda_o_ + lambda(wi, skin_.alpha));
  const float coat =
      ggx(h, skin_.alpha) * schlick(skin_.f0, skin_.f90, wo_.dot(h)) * masking / (4.0f * wo_.z() * wi.z());
  const CoatAlbedo e = render::coat_albedo(wi.z(), skin_.alpha);
  const float through = base_scale_ * (1.0f - skin_.f0 * e.a - skin_.f90 * e.b);
  return skin_.albedo * (through / pi) + Eigen::Vector3f::Constant(coat);
}

float Bsdf::pdf(const Eigen::Vector3f& wi) const {
  if (wo_.z() <= 0.0f || wi.z() <= 0.0f) return 0.0f;
  float result = (1.0f - coat_probability_) * wi.z() / pi;
  if (coat_probability_ > 0.0f) {
    const Eigen::Vector3f h = (wo_ + wi).normalized();
    result += coat_probability_ * ggx(h, skin_.alpha) / (4.0f * (1.0f + lambda_o_) * wo_.z());
  }
  return result;
}

Eigen::Vector3f Bsdf::sample(float choice, const Eigen::Vector2f& u) const {
  if (choice < coat_probability_) {
    const Eigen::Vector3f h = sample_visible_normal(wo_, skin_.alpha, u);
    return 2.0f * wo_.dot(h) * h - wo_;
  }
  const float r = std::sqrt(u.x()), phi = 2 * pi * u.y();
  return {r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(0.0f, 1.0f - u.x()))};
}

}  // namespace vultus::render
