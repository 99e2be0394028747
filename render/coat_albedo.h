#pragma once

namespace vultus::render {

/// Directional albedo of a GGX coat whose Fresnel term is F0 (1-x) + F90 x: E = F0 a + F90 b.
struct CoatAlbedo {
  float a = 0.0f, b = 0.0f;
};

CoatAlbedo coat_albedo(float mu, float alpha);  ///< towards a direction with cosine μ
CoatAlbedo mean_coat_albedo(float alpha);       ///< 2 ∫ E(μ) μ dμ of the same

}  // namespace vultus::render
