#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/virtual_stage/muscles.h"

namespace vultus::virtual_stage {

/// What a face does over time: `frames[f]` are the channels' strengths in frame f.
struct Performance {
  std::string name;
  double rate_hz = 120.0;
  std::vector<Activations> frames;
};

/// A pose held in a training take; frames from 0.
struct Hold {
  std::string pose;
  int first = 0, last = 0;
};

struct TrainingSession {
  Performance performance;
  std::vector<Hold> holds;  ///< in the order of the poses; the frames in which the pose is at its fullest
};

/// Every pose of the database in order, shown from and back to rest and held for `hold_seconds`, as people do it: each
/// once a little weaker or stronger, not quite even on both sides, with a slight sway while held.
TrainingSession training_session(const std::vector<std::string>& poses, double hold_seconds, double rate_hz,
                                 std::uint64_t seed);

/// Names of the performances: "speech", "emotions", "asymmetry".
const std::vector<std::string>& performance_names();

/// One of them, `seconds` long (its phrase of about 8 s is cut, or repeated with sides exchanged). Each has one-sided
/// actions: a half smile, a wink, one raised brow, a crooked jaw. Throws `InputError` for another name.
Performance perform(const std::string& name, double seconds, double rate_hz, std::uint64_t seed);

}  // namespace vultus::virtual_stage
