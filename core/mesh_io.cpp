#include "core/mesh_io.h"

#include <algorithm>
#include <cctype>

#include "core/error.h"
#include "core/files.h"
#include "core/mesh_files.h"

namespace vultus {
namespace mesh_files {

std::string texture_path(const std::filesystem::path& file, std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  const std::filesystem::path named = file.parent_path() / name;
  std::error_code error;
  if (std::filesystem::exists(named, error)) return named.string();
  return (file.parent_path() / std::filesystem::path(name).filename()).string();
}

Points points_from(const std::vector<double>& flat) {
  return Eigen::Map<const Points>(flat.data(), static_cast<Eigen::Index>(flat.size() / 3), 3);
}

std::shared_ptr<const Topology> make_topology(const std::filesystem::path& file, TopologyData data) {
  try {
    return Topology::make(std::move(data));
  } catch (const InputError& error) {
    throw InputError(file, error.what());
  }
}

void check_finite(const std::filesystem::path& file, const Points& positions, NonFinite non_finite) {
  if (non_finite == NonFinite::keep || positions.allFinite()) return;
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    if (!positions.row(v).allFinite()) {
      throw InputError(file, "vertex " + std::to_string(v), "its position is not finite");
    }
  }
}

}  // namespace mesh_files

namespace {

std::string lower_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension;
}

}  // namespace

Mesh read_mesh(const std::filesystem::path& file, NonFinite non_finite) {
  const std::string extension = lower_extension(file);
  const std::string content = read_file(file);
  if (content.empty()) throw InputError(file, "is empty");
  if (content.starts_with("ply")) return mesh_files::read_ply(file, content, non_finite);
  if (extension == ".obj") return mesh_files::read_obj(file, content, non_finite);
  if (extension == ".stl") return mesh_files::read_stl(file, content, non_finite);
  if (extension == ".ply") throw InputError(file, "byte 0", "a PLY file starts with \"ply\"");
  throw InputError(file, "is not a mesh; OBJ, PLY and STL are read");
}

}  // namespace vultus
