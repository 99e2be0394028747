#pragma once

#include <filesystem>

#include "mocap/take.h"

namespace vultus::mocap {

/// Reads a table of marker positions, one frame a row, in any of these forms (told apart by content):
/// - columns "label_x, label_y, label_z" (also ".x", " X", ":X"), with other columns passed over and "frame" or "time"
///   columns used where present;
/// - Motive's export (format version 1.x: rows of types, names, ids, properties and axes; metadata in the first row);
/// - Vicon Nexus' export (a "Trajectories" section with rate, labels, axes and units).
/// Separators are comma, semicolon or tab; with semicolons a decimal comma is accepted. Empty, NA and NaN cells are
/// missing. Throws `InputError` naming the line.
Take read_csv(const std::filesystem::path& file, const ReadOptions& options = {});

}  // namespace vultus::mocap
