#pragma once

#include <cstdint>

#include "core/progress.h"
#include "render/film.h"
#include "render/scene.h"

namespace vultus::render {

struct PathTracerOptions {
  int samples = 64;           ///< paths a pixel, at most; 1 to 65536
  double noise_target = 0.0;  ///< relative standard error of luminance at which a 16×16 tile stops; 0: all samples
  int bounces = 6;            ///< surface interactions a path, 1 to 64; 1 is direct light only
  std::uint64_t seed = 1;
  float clamp = 0.0f;  ///< largest radiance of one path; 0: none. A clamp removes fireflies and darkens: biased

  void validate() const;  ///< throws `UsageError`
};

struct PathTracerResult {
  Image layers;            ///< see `make_layers`
  std::uint64_t rays = 0;  ///< traced: camera, shadow and bounce rays
  std::uint64_t paths = 0;
  std::uint64_t rejected_paths = 0;  ///< whose radiance was not finite; they count as black
};

/// Path tracing (Kajiya 1986) with next-event estimation and multiple importance sampling between the environment and
/// the surface (Veach 1997, power heuristic), Russian roulette from the fourth interaction on, and a tent filter one
/// pixel in radius, drawn from rather than weighted. Tiles run in parallel (oneTBB); pixels depend on scene, options
/// and seed only. Throws `InputError` for a bad scene, `Cancelled` when `progress` says so.
PathTracerResult trace_paths(const Scene& scene, const PathTracerOptions& options,
                             Progress& progress = Progress::none());

}  // namespace vultus::render
