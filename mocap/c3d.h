#pragma once

#include <filesystem>

#include "mocap/take.h"

namespace vultus::mocap {

/// Reads a C3D file of any processor type, integer or real. What the header and the parameters say in contradiction is
/// settled by the size of the file; each such decision, and each repair, stands in `decisions`. Analog samples are
/// passed over. Samples with a negative residual, without finite coordinates or at exactly (0, 0, 0) are missing.
/// Memory: the take and one buffer of about a megabyte. Throws `InputError` naming the byte.
Take read_c3d(const std::filesystem::path& file, const ReadOptions& options = {});

/// Writes real-valued Intel C3D in millimetres, +y up: missing samples with residual -1, more than 255 labels through
/// LABELS2 and so on, more than 65,535 frames through TRIAL. Reading gives the same positions bit for bit; residuals
/// keep the take's `residual_step`, at most 255 steps each. Throws `OutputError`.
void write_c3d(const std::filesystem::path& file, const Take& take);

}  // namespace vultus::mocap
