#include "apps/virtual_stage/muscles.h"

#include <utility>

namespace vultus::virtual_stage {

const std::vector<std::string>& channel_names() {
  static const std::vector<std::string> names = [] {
    const char* muscles[muscle_count] = {
        "frontalis_inner",  "frontalis_outer", "brow_lowerer", "corrugator",       "lid_raiser",
        "cheek_raiser",     "lid_tightener",   "lid_closer",   "nose_wrinkler",    "nostril_flare",
        "upper_lip_raiser", "zygomaticus",     "dimpler",      "anguli_depressor", "lower_lip_depressor",
        "chin_raiser",      "risorius",        "pucker",       "funnel",           "lip_press",
        "upper_lip_roll",   "lower_lip_roll",  "lips_part",    "cheek_puff"};
    std::vector<std::string> all;
    for (const char* muscle : muscles)
      for (const char* side : {"_left", "_right"}) all.push_back(std::string(muscle) + side);
    for (const char* jaw : {"jaw_open", "jaw_left", "jaw_forward"}) all.emplace_back(jaw);
    return all;
  }();
  return names;
}

Activations mirrored(const Activations& activations) {
  Activations other = activations;
  for (int m = 0; m < muscle_count; ++m) std::swap(other[2 * m], other[2 * m + 1]);
  other[channel(Jaw::left)] = -other[channel(Jaw::left)];
  return other;
}

}  // namespace vultus::virtual_stage
