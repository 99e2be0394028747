#include "rig/actor.h"

#include <tbb/parallel_for.h>

#include <nlohmann/json.hpp>

#include "core/array_io.h"
#include "core/error.h"
#include "core/files.h"
#include "core/manifest.h"
#include "core/mesh_io.h"
#include "rig/database.h"
#include "rig/markers.h"
#include "rig/pending_files.h"
#include "rig/topology_file.h"

namespace vultus::rig {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

Manifest open_actor(const fs::path& folder) {
  if (!fs::exists(folder / "actor.json"))
    throw InputError(folder, "is no actor folder: it has no actor.json; `vultus onboard` makes one");
  return Manifest::open(folder / "actor.json", "actor");
}

std::vector<std::string> expected_artefacts(const Manifest& manifest) {
  std::vector<std::string> names = manifest.artefacts();
  if (const auto pending = manifest.facts().find("pending"); pending != manifest.facts().end())
    for (const auto& [artefact, hash] : pending->at("files").items())
      if (!manifest.has(artefact)) names.push_back(artefact);
  return names;
}

std::vector<std::string> damaged(const Manifest& manifest) {
  std::vector<std::string> names;
  for (const std::string& artefact : expected_artefacts(manifest)) {
    try {
      current_path(manifest, artefact);
    } catch (const InputError&) {
      names.push_back(artefact);
    }
  }
  return names;
}

bool has(const Manifest& manifest, const std::string& artefact) {
  const auto pending = manifest.facts().find("pending");
  return manifest.has(artefact) || (pending != manifest.facts().end() && pending->at("files").contains(artefact));
}

void require_sound(const Manifest& manifest) {
  std::string list;
  for (const std::string& artefact : damaged(manifest)) list += (list.empty() ? "" : ", ") + artefact;
  if (!list.empty())
    throw InputError(manifest.folder(), "missing, damaged or edited since it was made: " + list +
                                            "; run the command that made it again, with --force");
}

Points read_pose(const fs::path& file, int vertex_count) {
  Points positions = read_mesh(file).positions;
  if (positions.rows() != vertex_count)
    throw InputError(file, "has " + std::to_string(positions.rows()) + " vertices, the topology has " +
                               std::to_string(vertex_count));
  return positions;
}

void read_poses(const Manifest& manifest, Actor& actor) {
  for (const Json& entry : manifest.facts().at("poses"))
    actor.poses.push_back({entry.at("name"), entry.value("tags", std::vector<std::string>()), {}});
  if (actor.poses.empty() || actor.poses.front().name != "neutral")
    throw InputError(manifest.folder() / "actor.json", "the first pose must be \"neutral\"");
  tbb::parallel_for(std::size_t{0}, actor.poses.size(), [&](std::size_t i) {
    const std::string artefact = "poses/" + actor.poses[i].name + ".ply";
    if (!has(manifest, artefact)) throw InputError(manifest.folder() / artefact, "is listed but was never recorded");
    actor.poses[i].positions = read_pose(current_path(manifest, artefact), actor.topology->vertex_count());
  });
}

/// Images of few channels are kept as half floats, whose rounding leaves sums near one, not at it.
void normalize_texels(Image& masks) {
  const auto channels = static_cast<std::size_t>(masks.channels());
  for (std::size_t first = 0; first + channels <= masks.pixels().size(); first += channels) {
    float sum = 0.0F;
    for (std::size_t c = 0; c < channels; ++c) sum += masks.pixels()[first + c];
    if (!(sum > 0.0F)) continue;
    for (std::size_t c = 0; c < channels; ++c) masks.pixels()[first + c] /= sum;
  }
}

Actor read_actor(const Manifest& manifest) {
  Actor actor;
  const Json& facts = manifest.facts();
  if (facts.value("units", "") != "mm") throw InputError(manifest.folder() / "actor.json", "units must be \"mm\"");
  if (!has(manifest, "topology.obj")) throw InputError(manifest.folder(), "has no topology; run onboarding again");
  StoredTopology stored =
      read_topology(current_path(manifest, "topology.obj"), current_path(manifest, "topology.json"));
  actor.name = facts.value("name", "");
  actor.template_name = stored.template_name;
  actor.topology = stored.topology;
  actor.rest = std::move(stored.rest);
  actor.ibug68 = stored.ibug68;
  read_poses(manifest, actor);
  read_regions(manifest, actor);
  if (has(manifest, "markers.json"))
    actor.markers = read_markers(current_path(manifest, "markers.json"), *actor.topology);
  if (has(manifest, "maps/neutral/albedo.exr"))
    actor.albedo = read_image(current_path(manifest, "maps/neutral/albedo.exr"));
  return actor;
}

}  // namespace

void read_regions(const Manifest& manifest, Actor& actor) {
  if (!has(manifest, "regions/regions.json")) return;
  const fs::path names_file = current_path(manifest, "regions/regions.json");
  const Json names = read_json(names_file).at("regions");
  const Array masks = read_npy(current_path(manifest, "regions/vertex_masks.npy"));
  actor.region_masks = read_image(current_path(manifest, "regions/masks.exr"), Encoding::raw);
  normalize_texels(actor.region_masks);
  actor.regions.clear();
  const std::size_t count = names.size();
  const auto vertices = static_cast<std::size_t>(actor.topology->vertex_count());
  if (masks.shape != std::vector<std::size_t>{vertices, count} ||
      actor.region_masks.channels() != static_cast<int>(count))
    throw InputError(names_file, "its regions, the vertex masks and the mask image do not agree");
  for (std::size_t r = 0; r < count; ++r) {
    Region region{names[r].at("name"), Eigen::VectorXf(static_cast<Eigen::Index>(vertices))};
    for (std::size_t v = 0; v < vertices; ++v)
      region.vertex_mask[static_cast<Eigen::Index>(v)] = masks.values[v * count + r];
    actor.regions.push_back(std::move(region));
  }
}

std::vector<std::string> Actor::pose_names() const {
  std::vector<std::string> names;
  names.reserve(poses.size());
  for (const Pose& pose : poses) names.push_back(pose.name);
  return names;
}

int Actor::pose_index(const std::string& pose) const {
  for (std::size_t i = 0; i < poses.size(); ++i)
    if (poses[i].name == pose) return static_cast<int>(i);
  const std::string nearest = nearest_name(pose, pose_names());
  throw InputError("actor \"" + name + "\" has no pose \"" + pose + "\"" +
                   (nearest.empty() ? std::string() : "; did you mean \"" + nearest + "\"?"));
}

Actor load_actor(const fs::path& folder) {
  const Manifest manifest = open_actor(folder);
  require_sound(manifest);
  try {
    return read_actor(manifest);
  } catch (const Json::exception& error) {
    throw InputError(folder / "actor.json", std::string("is not an actor's manifest: ") + error.what());
  }
}

std::vector<std::string> damaged_artefacts(const fs::path& folder) { return damaged(open_actor(folder)); }

std::vector<std::string> map_names(const fs::path& folder, const std::string& pose) {
  const std::string prefix = "maps/" + pose + "/";
  std::vector<std::string> names;
  for (const std::string& artefact : expected_artefacts(open_actor(folder)))
    if (artefact.starts_with(prefix)) names.push_back(fs::path(artefact).stem().string());
  return names;
}

Image load_map(const fs::path& folder, const std::string& pose, const std::string& map) {
  const Manifest manifest = open_actor(folder);
  const std::string artefact = "maps/" + pose + "/" + map + ".exr";
  if (has(manifest, artefact)) return read_image(current_path(manifest, artefact));
  std::string list;
  for (const std::string& name : map_names(folder, pose)) list += (list.empty() ? "" : ", ") + name;
  throw InputError(folder,
                   "pose \"" + pose + "\" has no map \"" + map + "\"; it has " + (list.empty() ? "none" : list));
}

}  // namespace vultus::rig
