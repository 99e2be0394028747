#pragma once

#include <filesystem>

#include "apps/virtual_stage/volume_faults.h"

namespace vultus::virtual_stage {

/// Faults as a tracker leaves them in a take, `times` as many, 0 … 20: swaps, phantoms, fragments, spikes, dropouts,
/// held frames, and a target of the jig that slips by 3 mm.
FaultOptions usual_faults(std::uint64_t seed, double times);

/// Writes into `folder` what was done to a take, so that a cleaned one can be scored:
///
///     faults.json    {"faults": [{"kind", "first", "last", "markers": [LABEL…], "column": LABEL, "size_mm"}…],
///                     "slip": {"marker", "first", "last"}}; frames from 0, both ends; `markers` absent: all of them;
///                     `size_mm` of spikes alone
///     owners.npy     frames × columns of the delivered take: the true marker's number, -1 no sample, -2 no marker
///     recorded.c3d   the take before the faults: noise and gaps, every sample under its own label
void write_fault_truth(const std::filesystem::path& folder, const RecordedTake& recorded, const FaultyTake& faulty);

}  // namespace vultus::virtual_stage
