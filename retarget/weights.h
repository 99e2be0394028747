#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/mesh.h"

namespace vultus::retarget {

/// Blendshape weights of a take: frames × regions × poses; each row of poses is ≥ 0 and sums to one (Liu eq. 1–2).
struct Weights {
  double rate_hz = 0.0;
  std::vector<std::string> regions;
  std::vector<std::string> poses;
  std::vector<float> values;

  int frames() const;
  std::span<float> at(int frame, int region);
  std::span<const float> at(int frame, int region) const;
  static Weights zeros(double rate_hz, std::vector<std::string> regions, std::vector<std::string> poses, int frames);
};

/// `weights.npy` beside `weights.json`, which names the axes. Throws `InputError` when they disagree.
void write_weights(const std::filesystem::path& npy, const Weights& weights);
Weights read_weights(const std::filesystem::path& npy);

}  // namespace vultus::retarget
