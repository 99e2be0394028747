#pragma once

#include <string>
#include <vector>

#include "mocap/rigid_body.h"

namespace vultus::mocap {

/// A marker of the jig that has moved on it.
struct JigSlip {
  std::string label;
  int frame = 0;          ///< the first in which it is away from its old place
  int settled = -1;       ///< the first in which it rests at its new place; -1: never
  double distance = 0.0;  ///< mm, from the old place to the new one
};

struct SlipOptions {
  double least_mm = 0.4;  ///< smaller moves are no slips, > 0
  double factor = 5.0;    ///< nor are those below this many times the marker's own scatter, > 1
  void validate() const;  ///< throws `UsageError`
};

/// The first slip of each marker of the body, in order of frames. `poses` are robust fits of the body to the take, so
/// that they follow the markers that have not slipped; a marker's place on the body over time, in medians of a tenth of
/// a second, is cut in two where the halves differ most (least squares), and the moment is then looked for in single
/// frames. With `known_places` the body is that of another take, and a marker that is elsewhere from the start has
/// slipped at frame 0.
std::vector<JigSlip> find_slips(const Take& take, const RigidBody& body, const std::vector<HeadPose>& poses,
                                bool known_places, const SlipOptions& options = {});

/// The take without the samples that slipped markers have from then on.
Take without_slipped(const Take& take, const std::vector<JigSlip>& slips);

}  // namespace vultus::mocap
