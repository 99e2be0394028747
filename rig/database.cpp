#include "rig/database.h"

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>

#include "core/array_io.h"
#include "core/error.h"
#include "core/files.h"
#include "core/mesh_io.h"
#include "rig/markers.h"
#include "rig/pending_files.h"
#include "rig/topology_file.h"

namespace vultus::rig {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kMasks = "regions/masks.exr";
constexpr const char* kVertexMasks = "regions/vertex_masks.npy";
constexpr const char* kRegions = "regions/regions.json";
constexpr const char* kTopology = "topology.obj";
constexpr const char* kTopologyNames = "topology.json";
constexpr const char* kMarkers = "markers.json";

void check_name(const std::string& name, const std::string& what) {
  const bool plain = std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
  });
  if (name.empty() || name.front() == '.' || !plain)
    throw InputError(what + " \"" + name + "\": names are letters, digits, '_', '-' and '.', not starting with '.'");
}

std::string pose_file(const std::string& pose) { return "poses/" + pose + ".ply"; }
std::string map_file(const std::string& pose, const std::string& map) { return "maps/" + pose + "/" + map + ".exr"; }

Json& pose_list(Manifest& manifest) {
  Json& poses = manifest.facts()["poses"];
  if (!poses.is_array()) poses = Json::array();
  return poses;
}

void list_pose(Manifest& manifest, const Pose& pose) {
  Json& poses = pose_list(manifest);
  const Json entry = {{"name", pose.name}, {"tags", pose.tags}};
  const auto found = std::find_if(poses.begin(), poses.end(), [&](const Json& p) { return p.at("name") == pose.name; });
  if (found != poses.end())
    *found = entry;
  else
    poses.insert(pose.name == "neutral" ? poses.begin() : poses.end(), entry);
}

void require_finite(const Points& positions, const std::string& what) {
  for (Eigen::Index v = 0; v < positions.rows(); ++v)
    if (!positions.row(v).allFinite())
      throw InputError(what + ": vertex " + std::to_string(v) + " is not a finite position");
}

Array mask_array(const std::vector<Region>& regions, int vertex_count) {
  Array array = Array::zeros({static_cast<std::size_t>(vertex_count), regions.size()});
  for (std::size_t r = 0; r < regions.size(); ++r) {
    if (regions[r].vertex_mask.size() != vertex_count)
      throw InputError("region \"" + regions[r].name + "\" has " + std::to_string(regions[r].vertex_mask.size()) +
                       " mask values for " + std::to_string(vertex_count) + " vertices");
    for (int v = 0; v < vertex_count; ++v) array.values[v * regions.size() + r] = regions[r].vertex_mask[v];
  }
  return array;
}

}  // namespace

ActorWriter::ActorWriter(const fs::path& folder, const std::string& name)
    : manifest_(Manifest::open(folder / "actor.json", "actor")) {
  finish_pending(manifest_);
  Json& facts = manifest_.facts();
  if (!name.empty()) facts["name"] = name;
  if (!facts.contains("name")) facts["name"] = fs::absolute(folder / ".").parent_path().filename().string();
  facts["units"] = "mm";
  pose_list(manifest_);
}

const std::shared_ptr<const Topology>& ActorWriter::topology() {
  if (!topology_) {
    if (!manifest_.has(kTopology))
      throw InputError(folder(), "has no topology yet; it is written before anything else");
    topology_ = read_topology(current_path(manifest_, kTopology), current_path(manifest_, kTopologyNames)).topology;
  }
  return topology_;
}

bool ActorWriter::topology_is_current(const Provenance& provenance) const {
  return manifest_.is_current(kTopology, provenance) && manifest_.is_current(kTopologyNames, provenance);
}

void ActorWriter::write_topology(const Mesh& rest, const std::string& template_name,
                                 const std::optional<registration::Ibug68>& ibug68, const Provenance& provenance) {
  require_finite(rest.positions, "template \"" + template_name + "\"");
  const Json names = names_json(*rest.topology, ibug68, template_name);
  const std::string old_hash = manifest_.has(kTopology) ? manifest_.hash(kTopology) : "";
  const auto write_shape = [&](const fs::path& file) { write_obj(file, rest); };
  const auto write_names = [&](const fs::path& file) { write_json(file, names); };
  commit_files(manifest_, {{kTopology, write_shape}, {kTopologyNames, write_names}}, provenance, [&](Manifest& m) {
    m.facts()["template"] = template_name;
    m.facts()["vertex_count"] = rest.topology->vertex_count();
    if (old_hash.empty() || old_hash == pending_hash(m, kTopology)) return;
    for (const std::string& artefact : m.artefacts())
      if (artefact != kTopology && artefact != kTopologyNames) m.forget(artefact);
    m.facts()["poses"] = Json::array();
  });
  topology_ = rest.topology;
  remove_unlisted(manifest_, {"poses", "regions", "maps"});
}

bool ActorWriter::pose_is_current(const std::string& pose, const Provenance& provenance) const {
  return manifest_.is_current(pose_file(pose), provenance);
}

void ActorWriter::write_pose(const Pose& pose, const Provenance& provenance) {
  check_name(pose.name, "pose");
  if (pose.positions.rows() != topology()->vertex_count())
    throw InputError("pose \"" + pose.name + "\" has " + std::to_string(pose.positions.rows()) +
                     " vertices, the actor's topology has " + std::to_string(topology()->vertex_count()));
  require_finite(pose.positions, "pose \"" + pose.name + "\"");
  const auto write = [&](const fs::path& file) { write_ply(file, {topology(), pose.positions, {}, {}}); };
  commit_files(manifest_, {{pose_file(pose.name), write}}, provenance, [&](Manifest& m) { list_pose(m, pose); });
}

std::vector<std::string> ActorWriter::pose_names() const {
  std::vector<std::string> names;
  for (const Json& pose : manifest_.facts().at("poses")) names.push_back(pose.at("name"));
  return names;
}

void ActorWriter::keep_poses(const std::vector<std::string>& names) {
  const std::vector<std::string> known = pose_names();
  Json kept = Json::array();
  for (const std::string& name : names) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end()) {
      const std::string nearest = nearest_name(name, known);
      throw InputError(folder(), "has no pose \"" + name + "\"" +
                                     (nearest.empty() ? std::string() : "; did you mean \"" + nearest + "\"?"));
    }
    kept.push_back(pose_list(manifest_)[static_cast<std::size_t>(found - known.begin())]);
  }
  for (const std::string& name : known) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    for (const std::string& artefact : manifest_.artefacts())
      if (artefact == pose_file(name) || artefact.starts_with("maps/" + name + "/")) manifest_.forget(artefact);
  }
  pose_list(manifest_) = kept;
  manifest_.save();
  remove_unlisted(manifest_, {"poses", "maps"});
}

bool ActorWriter::regions_are_current(const Provenance& provenance) const {
  return vultus::rig::regions_are_current(manifest_, provenance);
}

void ActorWriter::write_regions(const std::vector<Region>& regions, const Image& masks, const Provenance& provenance) {
  vultus::rig::write_regions(manifest_, topology()->vertex_count(), regions, masks, provenance);
}

bool ActorWriter::markers_are_current(const Provenance& provenance) const {
  return manifest_.is_current(kMarkers, provenance);
}

void ActorWriter::write_markers(const std::map<std::string, SurfacePoint>& markers, const Provenance& provenance) {
  const auto triangles = topology()->triangles().rows();
  for (const auto& [label, place] : markers)
    if (place.triangle < 0 || place.triangle >= triangles)
      throw InputError("marker \"" + label + "\" lies on no triangle of the topology");
  const auto write = [&](const fs::path& file) { vultus::rig::write_markers(file, markers); };
  commit_files(manifest_, {{kMarkers, write}}, provenance);
}

bool ActorWriter::map_is_current(const std::string& pose, const std::string& map, const Provenance& provenance) const {
  return manifest_.is_current(map_file(pose, map), provenance);
}

void ActorWriter::write_map(const std::string& pose, const std::string& map, const Image& image,
                            const Provenance& provenance) {
  check_name(pose, "pose");
  check_name(map, "map");
  const auto write = [&](const fs::path& file) { write_image(file, image); };
  commit_files(manifest_, {{map_file(pose, map), write}}, provenance);
}

bool regions_are_current(const Manifest& manifest, const Provenance& provenance) {
  return manifest.is_current(kMasks, provenance) && manifest.is_current(kVertexMasks, provenance) &&
         manifest.is_current(kRegions, provenance);
}

void write_regions(Manifest& manifest, int vertex_count, const std::vector<Region>& regions, const Image& masks,
                   const Provenance& provenance) {
  Json names = Json::array();
  for (const Region& region : regions) {
    check_name(region.name, "region");
    names.push_back({{"name", region.name}});
  }
  if (regions.empty() || masks.channels() != static_cast<int>(regions.size()))
    throw InputError("regions: expected one mask channel for each of at least one region");
  const Array vertex_masks = mask_array(regions, vertex_count);
  commit_files(manifest,
               {{kMasks, [&](const fs::path& file) { write_image(file, masks); }},
                {kVertexMasks, [&](const fs::path& file) { write_npy(file, vertex_masks); }},
                {kRegions,
                 [&](const fs::path& file) {
                   write_json(file, {{"regions", names}});
                 }}},
               provenance);
}

void save_actor(const fs::path& folder, const Actor& actor, const Provenance& provenance) {
  ActorWriter writer(folder, actor.name);
  const Points& rest = actor.rest.rows() > 0 ? actor.rest : actor.neutral();
  writer.write_topology({actor.topology, rest, {}, {}}, actor.template_name, actor.ibug68, provenance);
  for (const Pose& pose : actor.poses) writer.write_pose(pose, provenance);
  writer.keep_poses(actor.pose_names());
  if (!actor.regions.empty()) writer.write_regions(actor.regions, actor.region_masks, provenance);
  if (!actor.markers.empty()) writer.write_markers(actor.markers, provenance);
  if (!actor.albedo.empty()) writer.write_map("neutral", "albedo", actor.albedo, provenance);
}

}  // namespace vultus::rig
