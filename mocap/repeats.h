#pragma once

#include <string>
#include <vector>

#include "mocap/take.h"

namespace vultus::mocap {

/// A stretch in which nothing was measured although the file has values: each frame repeats the one before to the bit.
struct Repeat {
  enum class Kind {
    held,       ///< frames stand in for lost ones: the motion goes on behind them; their samples become missing
    doubled,    ///< frames put in: the motion stands still for them; they are taken out
    marker,     ///< one marker keeps its place while it or the others move; its samples become missing
    lower_rate  ///< the whole take was recorded at a lower rate and each frame written several times: only reported
  };
  Kind kind = Kind::held;
  int marker = -1;  ///< of Kind::marker
  int first = 0, last = 0;
  int times = 1;  ///< of Kind::lower_rate: how often each frame stands there
  int frames() const { return last - first + 1; }
};

/// Repeats of whole frames (three markers or more, all to the bit), then of single markers, each by frame. Held or
/// doubled is told by the step across the stretch along the motion before and after: as many frames' worth as it is
/// long, or one; held where the motion is too slow against the noise to tell. Takes of which more than a fifth repeats
/// in short stretches are found to be of a lower rate where the pattern is regular, else at rest or coarsely rounded:
/// nothing is found there then, nor in a take that hardly ever changes. A marker's stretch counts when chance would
/// not make one in a hundred such takes and it ends with a leap (rounded files do repeat, most where motion turns);
/// one that never ends, when most of the other markers move on meanwhile.
std::vector<Repeat> find_repeats(const Take& take);

/// Held samples missing, doubled frames out; `file_frames` then says which are left.
Take without(Take take, const std::vector<Repeat>& repeats);

/// "held", "doubled", "marker", "lower_rate".
std::string name_of(Repeat::Kind kind);
Repeat::Kind repeat_kind(const std::string& name);  ///< throws `InputError` for an unknown name

}  // namespace vultus::mocap
