#pragma once

#include <filesystem>
#include <string>

#include "render/sequence.h"

namespace vultus::apps {

struct RenderRequest {
  std::filesystem::path session;
  std::string take;
  std::string frames;               ///< "A:B" (apps/frame_range.h); empty: all
  int count = 0;                    ///< at most so many frames, spread evenly over the range; 0: all of it
  std::filesystem::path film;       ///< also make a film at the pace of the take; empty: none
  render::SequenceOptions options;  ///< `first`, `last` and `step` come from `frames` and `count`
};

/// Path-traces frames of a session's take into render/<take>/reference/; frames that are current stay. Throws
/// `UsageError` for an unknown take or frame.
render::SequenceResult render_take(const RenderRequest& request, Progress& progress);

}  // namespace vultus::apps
