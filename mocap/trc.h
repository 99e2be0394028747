#pragma once

#include <filesystem>

#include "mocap/take.h"

namespace vultus::mocap {

/// Reads a TRC file (Motion Analysis): tab-separated, three columns a marker, blank where a marker is missing. Rows
/// shorter than the header are filled with missing markers; the axes are taken as +y up unless told otherwise. Throws
/// `InputError` naming the line.
Take read_trc(const std::filesystem::path& file, const ReadOptions& options = {});

/// Writes millimetres with enough digits to give the same floats again; missing samples are blank. Residuals, camera
/// masks and events have no place in TRC. Throws `OutputError`.
void write_trc(const std::filesystem::path& file, const Take& take);

}  // namespace vultus::mocap
