#include "apps/scan_file.h"

#include "core/error.h"
#include "core/mesh_io.h"

namespace vultus::apps {

scan::CleanScan clean_scan_file(const std::filesystem::path& file, const scan::CleanOptions& options,
                                Progress& progress, const Eigen::Matrix3d& upright) {
  Mesh raw = read_mesh(file, NonFinite::keep);
  if (!upright.isIdentity()) raw.positions = (raw.positions * upright.transpose()).eval();
  try {
    return scan::clean_scan(raw, options, progress);
  } catch (const InputError& error) {
    throw InputError(file, error.what());
  }
}

}  // namespace vultus::apps
