#pragma once

#include <filesystem>

#include "scan/clean.h"

namespace vultus::apps {

/// Reads a raw scan, turns it by `upright`, and cleans it; every `InputError` names the file.
scan::CleanScan clean_scan_file(const std::filesystem::path& file, const scan::CleanOptions& options,
                                Progress& progress, const Eigen::Matrix3d& upright = Eigen::Matrix3d::Identity());

}  // namespace vultus::apps
