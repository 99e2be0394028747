#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>

#include "core/progress.h"

namespace vultus::apps::bench_mocap {

struct SpeedOptions {
  double seconds = 600.0;  ///< length of the take, at 120 Hz with 104 markers
  std::uint64_t seed = 1;
};

/// Writes a long take (`long_take`) as C3D and TRC into a temporary folder, reads both back and cleans it:
///   read_seconds, read_memory_ratio            one reading of the C3D; the memory it adds, by the file's float data
///   read_text_seconds, read_text_memory_ratio  the same of the TRC, by the same float data
///   clean_seconds, clean_memory_ratio          reading, `mocap::clean`, writing C3D and samples.json; the memory it
///                                              adds, by the take's size in memory
///   clean_frames, clean_markers, float_data_bytes, take_bytes
/// The memory figures are null where the system does not tell. Throws `OutputError`, `Cancelled`.
nlohmann::json mocap_speed(const SpeedOptions& options, Progress& progress);

}  // namespace vultus::apps::bench_mocap
