#pragma once

#include <cstdint>
#include <vector>

#include "rig/actor.h"
#include "rig/motion_field.h"

namespace vultus::rig {

enum class SegmentationMethod {
  motion,  ///< clusters of like motion over all poses, merged by least variance
  liu,     ///< as published: clusters of like principal direction, merged by vertex counts
};

struct SegmentationOptions {
  SegmentationMethod method = SegmentationMethod::motion;
  int regions = 6;         ///< how many; 1: the whole face; 0: decided by `min_vertices`
  int min_vertices = 0;    ///< no patch that is merged last has fewer; 0: of the vertices that move a twelfth with
                           ///< regions = 0, else a hundredth (motion) or no limit (liu)
  int clusters = 0;        ///< of k-means, before merging; 0: liu 8, motion 4 for each region and at least 64
  std::uint64_t seed = 1;  ///< of k-means++
  bool symmetric = true;   ///< regions mirror each other across x = 0 of the actor's rest shape
  void validate() const;   ///< throws `InputError`
};

/// A division of the face into connected regions that move on their own (Liu et al. 2011 §3.2.1).
struct Segmentation {
  std::vector<int> labels;  ///< vertex_count; every vertex has a region, numbered by first vertex
  int regions = 0;
  MotionField field;  ///< coordinated principal directions
  Coordination coordination;
  std::vector<bool> moving;  ///< vertex_count; others took the region of the nearest moving vertex
  std::vector<int> follows;  ///< vertex_count; skin vertex that a part apart from the skin follows, -1 on the skin
};

/// Divides an actor's skin, the largest connected part of its topology, within its vertex set "face" and without its
/// set "hidden" where it has them. Other skin (inside of the mouth) and what no pose moves (back of the head) belongs
/// to the nearest region; parts apart from the skin (eyeballs, teeth) follow it (rig/attachments.h). Both methods
/// cluster with k-means, split clusters into connected patches and merge those. Throws `InputError` when nothing moves,
/// or when there are fewer patches than regions asked for.
Segmentation segment(const Actor& actor, const SegmentationOptions& options = {});

}  // namespace vultus::rig
