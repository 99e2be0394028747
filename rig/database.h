#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/manifest.h"
#include "rig/actor.h"

namespace vultus::rig {

/// Builds an actor folder (DESIGN §2) one artefact at a time:
///   actor.json            manifest: name, units, template, poses with tags in order, provenance and hash of each file
///   topology.obj/.json    polygons, UVs and the template's rest shape; vertex sets and landmarks (template.json's
///   form) poses/<pose>.ply      regions/{masks.exr,vertex_masks.npy,regions.json} maps/<pose>/<map>.exr markers.json
/// Every `write_…` is one transaction: files are written aside, announced in the manifest and then moved, so that a
/// process that dies leaves the previous state or the new one; the next writer or reader finishes a move cut short.
/// The `…_current` questions let a second run skip what an equal `Provenance` already made.
/// Names of poses and maps are letters, digits, '_', '-' and '.', not starting with '.'; others are an `InputError`.
class ActorWriter {
 public:
  /// Continues the actor in `folder` or starts one; `name` empty keeps the recorded name or takes the folder's.
  explicit ActorWriter(const std::filesystem::path& folder, const std::string& name = {});

  bool topology_is_current(const Provenance& provenance) const;
  /// `rest` is the template's shape on the actor's topology. Another topology than the recorded one drops every pose,
  /// region, marker and map, since they no longer fit.
  void write_topology(const Mesh& rest, const std::string& template_name,
                      const std::optional<registration::Ibug68>& ibug68, const Provenance& provenance);

  bool pose_is_current(const std::string& pose, const Provenance& provenance) const;
  /// Adds or replaces a pose; "neutral" is always listed first, others in the order of their first writing.
  void write_pose(const Pose& pose, const Provenance& provenance);
  /// Drops poses that are not named and lists the others in this order. Unknown names are an `InputError`.
  void keep_poses(const std::vector<std::string>& names);
  std::vector<std::string> pose_names() const;

  bool regions_are_current(const Provenance& provenance) const;
  /// Each vertex mask has vertex_count rows; `masks` has one channel a region, in order, named like the regions.
  void write_regions(const std::vector<Region>& regions, const Image& masks, const Provenance& provenance);

  bool markers_are_current(const Provenance& provenance) const;
  void write_markers(const std::map<std::string, SurfacePoint>& markers, const Provenance& provenance);

  bool map_is_current(const std::string& pose, const std::string& map, const Provenance& provenance) const;
  /// maps/<pose>/<map>.exr; the neutral's "albedo" is what `Actor::albedo` holds.
  void write_map(const std::string& pose, const std::string& map, const Image& image, const Provenance& provenance);

  /// For artefacts of other stages in the same folder, such as report/…; call its `save()` afterwards.
  Manifest& manifest() { return manifest_; }
  const std::filesystem::path& folder() const { return manifest_.folder(); }

 private:
  const std::shared_ptr<const Topology>& topology();

  Manifest manifest_;
  std::shared_ptr<const Topology> topology_;  // read when first needed
};

/// Regions in the actor folder's form in another folder, such as a session's own division of the face.
bool regions_are_current(const Manifest& manifest, const Provenance& provenance);
void write_regions(Manifest& manifest, int vertex_count, const std::vector<Region>& regions, const Image& masks,
                   const Provenance& provenance);
/// Replaces the actor's regions by those of such a folder; leaves the actor as it is when there are none.
void read_regions(const Manifest& manifest, Actor& actor);

/// Writes a whole actor at once with one provenance, current artefacts included.
void save_actor(const std::filesystem::path& folder, const Actor& actor, const Provenance& provenance);

/// Artefacts of an actor folder that are missing or differ from their record; empty for a sound folder.
std::vector<std::string> damaged_artefacts(const std::filesystem::path& folder);

/// One verified map of a pose; throws `InputError` when the actor has none of that name, with the names it has.
Image load_map(const std::filesystem::path& folder, const std::string& pose, const std::string& map);
std::vector<std::string> map_names(const std::filesystem::path& folder, const std::string& pose);

}  // namespace vultus::rig
