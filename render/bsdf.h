#pragma once

#include <Eigen/Core>

namespace vultus::render {

/// What a point of the surface is made of: a diffuse base under a rough dielectric coat.
struct Skin {
  Eigen::Vector3f albedo = Eigen::Vector3f::Constant(0.5f);  ///< of the base, [0, 1]
  float alpha = 0.2f;                                        ///< GGX width, > 0
  float f0 = 0.028f;                                         ///< reflectance of the coat at normal incidence, [0, 1]
  float f90 = 1.0f;                                          ///< and at grazing incidence, [0, 1]; both 0: no coat
};

/// Scattering by `Skin` towards one outgoing direction, in the frame whose z is the shading normal.
///
/// The coat is GGX (Walter et al. 2007) with height-correlated Smith masking (Heitz 2014) and Schlick's Fresnel term.
/// What the coat does not reflect, E(μ) being its directional albedo, reaches the base, whose Lambertian lobe becomes
/// albedo/π · (1-E(μi))(1-E(μo)) / (1-E_avg) (Kelemen and Szirmay-Kalos 2001): reciprocal, and with albedo 1 exactly as
/// much leaves as arrives.
class Bsdf {
 public:
  Bsdf(const Skin& skin, const Eigen::Vector3f& wo);  ///< `wo` unit; below the surface nothing scatters

  Eigen::Vector3f value(const Eigen::Vector3f& wi) const;  ///< f(wo, wi) in 1/sr, without the cosine
  float pdf(const Eigen::Vector3f& wi) const;              ///< density of `sample`, per steradian
  /// Draws wi: the coat by visible normals (Heitz 2018), the base by the cosine; `choice` in [0, 1) selects the lobe.
  /// The result may lie below the surface, where `value` and `pdf` are 0.
  Eigen::Vector3f sample(float choice, const Eigen::Vector2f& u) const;

  float coat_albedo() const { return coat_albedo_; }  ///< E(μo)

 private:
  Skin skin_;
  Eigen::Vector3f wo_;
  bool has_coat_ = false;
  float lambda_o_ = 0.0f, coat_albedo_ = 0.0f;
  float base_scale_ = 1.0f;        // (1-E(μo)) / (1-E_avg)
  float coat_probability_ = 0.0f;  // of choosing the coat when sampling
};

/// Width of the GGX lobe for a perceptual roughness in [0, 1] (Burley 2012).
float alpha_from_roughness(float roughness);
/// Normal reflectance of a dielectric with the given index of refraction.
float f0_from_ior(float ior);

/// Microfacet normal visible from `wo` (Heitz 2018) and its density per steradian.
Eigen::Vector3f sample_visible_normal(const Eigen::Vector3f& wo, float alpha, const Eigen::Vector2f& u);
float visible_normal_pdf(const Eigen::Vector3f& wo, const Eigen::Vector3f& h, float alpha);

}  // namespace vultus::render
